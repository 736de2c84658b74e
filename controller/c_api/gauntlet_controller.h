/* The controller for programs that are not C++: C, Python (ctypes), MATLAB (loadlibrary), ROS.
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
  GAUNTLET_WRONG_LENGTH = -2
} gauntlet_result;

/* A controller, to be given to gauntlet_controller_destroy(); allocates.
 *
 * settings: `settings_length` bytes of text; they need not end with 0 and are not kept.
 * error: NULL, or `error_size` bytes for one line, which ends with 0, that says what is wrong with
 * the settings; "" if nothing is.
 * Returns NULL if there is something wrong. */
gauntlet_controller* gauntlet_controller_create(const char* settings, size_t settings_length,
                                                char* error, size_t error_size);

/* NULL is allowed. */
void gauntlet_controller_destroy(gauntlet_controller* controller);

/* Sizes and clocks; all 0 for NULL. To be stepped `tick_rate_hz` times per second, with a new
 * sample of the glove at every `ticks_per_sample`-th step, beginning with the first. */
size_t gauntlet_controller_channel_count(const gauntlet_controller* controller);
size_t gauntlet_controller_motor_count(const gauntlet_controller* controller);
size_t gauntlet_controller_joint_count(const gauntlet_controller* controller);
double gauntlet_controller_tick_rate_hz(const gauntlet_controller* controller);
int gauntlet_controller_ticks_per_sample(const gauntlet_controller* controller);

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

/* Forgets the glove. The motors are at `motor_counts`, one per motor, as read from them: to be
 * called before the first step where the hand is not in its reference posture. With NULL and 0 the
 * hand stays where the last command has sent it. */
gauntlet_result gauntlet_controller_reset(gauntlet_controller* controller,
                                          const int32_t* motor_counts, size_t motor_count);

#ifdef __cplusplus
}
#endif
#ifdef __GNUC__
#pragma GCC visibility pop
#endif

#endif
/* NOLINTEND */
