/* The controller for programs that are not C++: C, Python (ctypes), MATLAB (loadlibrary).
 *
 * Plain C99; nothing is thrown across it. One thread at a time may use a controller; several
 * controllers do not know of each other. Except where said otherwise, no function allocates.
 * Settings: the text that `gauntlet export --text` writes. */
/* NOLINTBEGIN: this is C. */
#ifndef GAUNTLET_CONTROLLER_H
#define GAUNTLET_CONTROLLER_H

#include <stddef.h>
#include <stdint.h>

#ifdef __GNUC__ /* what the shared library shows */
#pragma GCC visibility push(default)
#endif
#ifdef __cplusplus
extern "C" {
#endif

typedef struct gauntlet_controller gauntlet_controller;

/* What functions that return a gauntlet_result say. Below 0 nothing has been done. */
typedef enum gauntlet_result {
  GAUNTLET_OK = 0,    /* of a step: the command is the one of before */
  GAUNTLET_EVENT = 1, /* of a step: a frame is due, the command is to be sent now */
  GAUNTLET_NULL_POINTER = -1,
  GAUNTLET_WRONG_LENGTH = -2,
  GAUNTLET_OUT_OF_RANGE = -3, /* no such channel, reason or kind of angle */
  GAUNTLET_NOT_PREPARED = -4  /* not made by gauntlet_controller_prepare() of this controller */
} gauntlet_result;

/* What a controller knows of its glove after the last step, the worst that holds of a channel. */
typedef enum gauntlet_glove_status {
  GAUNTLET_GLOVE_GOOD = 0,
  GAUNTLET_GLOVE_HELD = 1,      /* a channel holds its last trusted value */
  GAUNTLET_GLOVE_TOO_OFTEN = 2, /* samples come much more often than the settings say */
  GAUNTLET_GLOVE_LOST = 3       /* a channel had no trusted value for lost_after_ms */
} gauntlet_glove_status;

/* How the loop keeps to its rate, by the time between steps as it measured it. */
typedef enum gauntlet_loop_status {
  GAUNTLET_LOOP_IN_TIME = 0,   /* or the loop measures nothing */
  GAUNTLET_LOOP_OVERRUN = 1,   /* the last step came half a tick late or more */
  GAUNTLET_LOOP_WRONG_RATE = 2 /* most steps are too long or too short by more than 5 % */
} gauntlet_loop_status;

/* Why a sample is not trusted. */
typedef enum gauntlet_untrusted {
  GAUNTLET_UNTRUSTED_ALL = -1, /* for any of these reasons */
  GAUNTLET_UNTRUSTED_MISSING = 0,
  GAUNTLET_UNTRUSTED_INFINITE = 1,
  GAUNTLET_UNTRUSTED_OUT_OF_RANGE = 2,
  GAUNTLET_UNTRUSTED_FULL_SCALE = 3,
  GAUNTLET_UNTRUSTED_STUCK = 4,
  GAUNTLET_UNTRUSTED_JUMPED = 5,
  GAUNTLET_UNTRUSTED_STALE = 6
} gauntlet_untrusted;

/* Angles between glove and motors. */
typedef enum gauntlet_angle {
  GAUNTLET_ANGLE_LINEARISED = 0, /* per channel, before the filter */
  GAUNTLET_ANGLE_FILTERED = 1,   /* per channel, after it */
  GAUNTLET_ANGLE_PREDICTED = 2,  /* per channel, after the prediction */
  GAUNTLET_ANGLE_TARGET = 3      /* per joint: the command to the hand */
} gauntlet_angle;

/* Version of the library, as "1.2.3". */
const char* gauntlet_controller_version(void);

/* A controller, to be given to gauntlet_controller_destroy(); allocates.
 *
 * settings: `settings_length` bytes of text; they need not end with 0 and are not kept.
 * error: NULL, or `error_size` bytes for one line, which ends with 0, that says what is wrong with
 * the settings; "" if nothing is.
 * Returns NULL if there is something wrong. */
gauntlet_controller* gauntlet_controller_create(const char* settings, size_t settings_length,
                                                char* error, size_t error_size);

/* All that is wrong with settings, or doubtful, a line each; a doubtful one begins with "warning: ",
 * and a controller can be made nevertheless. Of text that cannot be read: the first error. Allocates.
 * problems: NULL, or `problems_size` bytes for as many of the lines as there is room for, with 0 at
 * the end. Returns how many there are. */
size_t gauntlet_controller_validate(const char* settings, size_t settings_length, char* problems,
                                    size_t problems_size);

/* NULL is allowed. */
void gauntlet_controller_destroy(gauntlet_controller* controller);

/* Sizes and clocks; all 0 for NULL. To be stepped `tick_rate_hz` times per second, with a new
 * sample of the glove at every `ticks_per_sample`-th step, beginning with the first. */
size_t gauntlet_controller_channel_count(const gauntlet_controller* controller);
size_t gauntlet_controller_motor_count(const gauntlet_controller* controller);
size_t gauntlet_controller_joint_count(const gauntlet_controller* controller);
double gauntlet_controller_tick_rate_hz(const gauntlet_controller* controller);
int gauntlet_controller_ticks_per_sample(const gauntlet_controller* controller);
double gauntlet_controller_event_period_ms(const gauntlet_controller* controller);

/* Names as in the settings; NULL beyond the last one. They live as long as the controller. */
const char* gauntlet_controller_channel_name(const gauntlet_controller* controller, size_t channel);
const char* gauntlet_controller_joint_name(const gauntlet_controller* controller, size_t joint);
const char* gauntlet_controller_motor_name(const gauntlet_controller* controller, size_t motor);

/* One tick with a new sample of the glove, or without one: `counts` NULL and `channel_count` 0.
 *
 * counts: the converter's counts, one per channel; NaN for a missing value.
 * motor_counts: gets one command per motor [motor counts], always within the motor's range. */
gauntlet_result gauntlet_controller_step(gauntlet_controller* controller, const double* counts,
                                         size_t channel_count, int32_t* motor_counts,
                                         size_t motor_count);

/* The same for a glove that counts its frames: late and repeated ones are not trusted. The numbers
 * begin anew behind `frame_number_bits` of the settings. */
gauntlet_result gauntlet_controller_step_frame(gauntlet_controller* controller,
                                               int64_t frame_number, const double* counts,
                                               size_t channel_count, int32_t* motor_counts,
                                               size_t motor_count);

/* What the hand's joint sensors say, one angle per joint [rad]; NaN for a joint that cannot be read.
 * To be called when there is a reading, for settings with a joint loop; others ignore it. */
gauntlet_result gauntlet_controller_take_joint_angles(gauntlet_controller* controller,
                                                      const double* angle_rad, size_t joint_count);

/* Time between the last step and the next one [ms], as the loop measured it: to be called before the
 * step. It changes no command; what is not above 0 is ignored. */
gauntlet_result gauntlet_controller_take_elapsed_ms(gauntlet_controller* controller,
                                                    double elapsed_ms);
/* After the last step; GAUNTLET_LOOP_IN_TIME for NULL. */
gauntlet_loop_status gauntlet_controller_loop_status(const gauntlet_controller* controller);
/* Steps since the last reset that came half a tick late or more; 0 for NULL. */
int64_t gauntlet_controller_overruns(const gauntlet_controller* controller);
/* Rate of the loop over the last 256 steps whose time is known [Hz]; NaN before, and for NULL. */
double gauntlet_controller_measured_tick_rate_hz(const gauntlet_controller* controller);

/* Forgets the glove. The motors are at `motor_counts`, one per motor, as read from them: to be
 * called before the first step where the hand is not in its reference posture. With NULL and 0 the
 * hand stays where the last command has sent it. */
gauntlet_result gauntlet_controller_reset(gauntlet_controller* controller,
                                          const int32_t* motor_counts, size_t motor_count);

/* After the last step; GAUNTLET_GLOVE_LOST for NULL. */
gauntlet_glove_status gauntlet_controller_glove_status(const gauntlet_controller* controller);

/* Samples of each channel since the last reset that were not trusted for this reason. */
gauntlet_result gauntlet_controller_untrusted_samples(const gauntlet_controller* controller,
                                                      gauntlet_untrusted reason,
                                                      int64_t* sample_counts, size_t channel_count);

/* Time since the last trusted value of each channel [ms], in steps of the loop. */
gauntlet_result gauntlet_controller_sample_age_ms(const gauntlet_controller* controller,
                                                  double* age_ms, size_t channel_count);

/* Command frames since the last reset in which no plan was found for a joint; all 0 for settings
 * that plan nothing. */
gauntlet_result gauntlet_controller_failed_plans(const gauntlet_controller* controller,
                                                 int64_t* frame_counts, size_t joint_count);

/* Angles after the last step [rad]; `count` is the number of channels, of joints for the target. */
gauntlet_result gauntlet_controller_angles(const gauntlet_controller* controller,
                                           gauntlet_angle kind, double* angle_rad, size_t count);

/* An inactive channel (`active` is 0) holds its joint at the present angle. */
gauntlet_result gauntlet_controller_set_channel_active(gauntlet_controller* controller,
                                                       size_t channel, int active);
/* 1 or 0; 0 also where there is no such channel. */
int gauntlet_controller_channel_active(const gauntlet_controller* controller, size_t channel);

/* Other settings for the same glove, hand, joint map and clocks, for gauntlet_controller_swap(). Any
 * thread may call it while another one steps; allocates. Arguments, errors and NULL as of
 * gauntlet_controller_create(). To be destroyed like that one. */
gauntlet_controller* gauntlet_controller_prepare(const gauntlet_controller* controller,
                                                 const char* settings, size_t settings_length,
                                                 char* error, size_t error_size);

/* Takes over what was prepared, from the next sample on, in the thread that steps; `prepared` has
 * the settings of before then, and can be swapped in again. */
gauntlet_result gauntlet_controller_swap(gauntlet_controller* controller,
                                         gauntlet_controller* prepared);

#ifdef __cplusplus
}
#endif
#ifdef __GNUC__
#pragma GCC visibility pop
#endif

#endif
/* NOLINTEND */
