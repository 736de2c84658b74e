/* A filter of your own as a shared library, for the trials of `gauntlet` and for `gauntlet live`:
 *
 *     filter: {kind: external, library: ./my_filter.so}
 *
 * The library exports gauntlet_filter_1(). Plain C99; nothing may be thrown across it. A filter is used by one
 * thread at a time, several filters by several. In `gauntlet live` the control thread calls step(), which should
 * neither allocate nor wait, and create() at the first sample. */
/* NOLINTBEGIN: this is C. */
#ifndef GAUNTLET_FILTER_H
#define GAUNTLET_FILTER_H

#ifdef __GNUC__ /* what your library shows */
#pragma GCC visibility push(default)
#endif
#ifdef __cplusplus
extern "C" {
#endif

#define GAUNTLET_FILTER_VERSION 1

/* What is known before the first sample. All pointers are valid during create() alone. */
typedef struct gauntlet_filter_facts {
  double rate_hz; /* samples per second */
  int channel_count;
  const char* const* channels; /* names */
  int parameter_count;
  const char* const* parameter_names; /* of `parameters` in the settings */
  const double* parameter_values;
} gauntlet_filter_facts;

typedef struct gauntlet_filter {
  int version; /* GAUNTLET_FILTER_VERSION */
  /* A new filter. NULL refuses, for the reason `*problem`, a text that lives as long as the library. */
  void* (*create)(const gauntlet_filter_facts* facts, const char** problem);
  /* A sample in, one value per channel, in counts or rad; as many finite values out. Any other answer
   * than 0 is a failure, which ends the trial; in `gauntlet live` samples pass unfiltered from then on. */
  int (*step)(void* filter, const double* input, double* output);
  /* The next sample of a channel is as its first one: those before were not trusted for a while. May be NULL. */
  void (*start_channel)(void* filter, int channel);
  void (*destroy)(void* filter);
} gauntlet_filter;

const gauntlet_filter* gauntlet_filter_1(void);

#ifdef __cplusplus
}
#endif
#ifdef __GNUC__
#pragma GCC visibility pop
#endif

#endif
/* NOLINTEND */
