// Switch channels off and on and load other settings between two samples; the rest goes on.

#include <cstdio>
#include <vector>

#include "controller/controller.h"

namespace gc = gauntlet::controller;

int main() {
  const gc::GloveCalibration glove = {.channel_names = {"thumb", "index", "middle"},
                                      .low_counts = {200, 200, 200},
                                      .high_counts = {800, 800, 800},
                                      .low_angle_rad = {0, 0, 0},
                                      .high_angle_rad = {1.5, 1.5, 1.5}};
  const gc::TendonTransmission hand = {.joint_names = {"thumb", "index", "middle"},
                                       .motor_names = {"thumb", "index", "middle"},
                                       .coupling = {1, 0, 0, 0, 1, 0, 0, 0, 1},
                                       .reference_angle_rad = {0, 0, 0},
                                       .joint_min_rad = {0, 0, 0},
                                       .joint_max_rad = {1.5, 1.5, 1.5},
                                       .counts_per_rad = {195, 195, 195},
                                       .center_counts = {300, 300, 300},
                                       .min_counts = {0, 0, 0},
                                       .max_counts = {1023, 1023, 1023}};
  gc::KalmanConfig kalman = {.noise = {.r = {20, 10, 10}, .q = {1e-3}}};
  gc::ControllerConfig config;
  config.filters = {{kalman}};
  gc::Controller controller(config, glove, hand);

  for (int k = 0; k < 400; ++k) {
    const std::vector<double> counts(3, 300.0 + k);
    if (k == 100) controller.SetChannelActive(1, false);  // the index finger stays where it is
    if (k == 200) {
      kalman.noise.r[2] = 200.0;  // the middle finger's sensor has become noisy
      config.filters = {{kalman}};
      controller.Load(config);
    }
    if (k == 300) controller.SetChannelActive(1, true);
    const gc::Command command = controller.Step({.counts = counts});
    if (k % 50 == 0) {
      std::printf("%3d ms  thumb %d  index %d  middle %d\n", k, command.motor_counts[0],
                  command.motor_counts[1], command.motor_counts[2]);
    }
  }
  try {
    config.filters = {{gc::ButterworthConfig{.cutoff_hz = 900.0}}};
    controller.Load(config);
    return 1;
  } catch (const gc::SettingError& error) {
    std::printf("refused, and still running: %s\n", error.what());
  }
  return 0;
}
