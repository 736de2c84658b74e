/* A robot's program in C: the settings that `gauntlet export --text` wrote, then where the motors
 * are and samples of the glove from the standard input, numbers between blanks. Prints the tick and
 * the command of every event.
 *
 *     07_from_c tuned.robot.txt < samples.txt */
#include <stdio.h>
#include <stdlib.h>

#include "controller/c_api/gauntlet_controller.h"

static gauntlet_controller* Load(const char* name) {
  static char settings[1 << 20];
  char error[200] = "cannot be read";
  gauntlet_controller* controller = NULL;
  FILE* file = fopen(name, "rb");
  if (file != NULL) {
    const size_t length = fread(settings, 1, sizeof settings, file);
    controller = gauntlet_controller_create(settings, length, error, sizeof error);
    fclose(file);
  }
  if (controller == NULL) fprintf(stderr, "%s: %s\n", name, error);
  return controller;
}

static void Drive(gauntlet_controller* controller, double* counts, int32_t* motors) {
  const size_t channels = gauntlet_controller_channel_count(controller);
  const size_t motor_count = gauntlet_controller_motor_count(controller);
  const int every = gauntlet_controller_ticks_per_sample(controller);
  long tick;
  size_t i;
  for (i = 0; i < motor_count; ++i) { /* read your servos here */
    if (scanf("%d", &motors[i]) != 1) return;
  }
  gauntlet_controller_reset(controller, motors, motor_count);
  for (tick = 0;; ++tick) { /* gauntlet_controller_tick_rate_hz() times per second */
    const int fresh = tick % every == 0;
    for (i = 0; fresh && i < channels; ++i) { /* read your glove here */
      if (scanf("%lf", &counts[i]) != 1) return;
    }
    if (gauntlet_controller_step(controller, fresh ? counts : NULL, fresh ? channels : 0, motors,
                                 motor_count) != GAUNTLET_EVENT) {
      continue;
    }
    printf("%ld", tick);
    for (i = 0; i < motor_count; ++i) printf(" %d", motors[i]); /* send them here */
    printf("\n");
  }
}

int main(int count, char** arguments) {
  gauntlet_controller* controller =
      Load(count > 1 ? arguments[1] : "controller/examples/robot.txt");
  double* counts;
  int32_t* motors;
  if (controller == NULL) return 2;
  counts = calloc(gauntlet_controller_channel_count(controller), sizeof *counts);
  motors = calloc(gauntlet_controller_motor_count(controller), sizeof *motors);
  if (counts != NULL && motors != NULL) Drive(controller, counts, motors);
  free(counts);
  free(motors);
  gauntlet_controller_destroy(controller);
  return 0;
}
