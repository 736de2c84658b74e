// What happens to samples that cannot be trusted, and how to see it.

#include <cstdio>
#include <limits>
#include <vector>

#include "controller/controller.h"

namespace gc = gauntlet::controller;

int main() {
  const gc::GloveCalibration glove = {.channel_names = {"index"},
                                      .low_counts = {200},
                                      .high_counts = {800},
                                      .low_angle_rad = {0},
                                      .high_angle_rad = {1.5}};
  const gc::TendonTransmission hand = {.joint_names = {"index"},
                                       .motor_names = {"index"},
                                       .coupling = {1},
                                       .reference_angle_rad = {0},
                                       .joint_min_rad = {0},
                                       .joint_max_rad = {1.5},
                                       .counts_per_rad = {195},
                                       .center_counts = {300},
                                       .min_counts = {0},
                                       .max_counts = {1023}};
  gc::ControllerConfig config;
  config.filters = {{gc::HampelConfig{}}, {gc::KalmanConfig{.noise = {.r = {10}, .q = {1e-2}}}}};
  gc::Controller controller(config, glove, hand, {.event_period_ms = 1.0});

  controller.Reset(std::vector<int>{446});  // where the motor is: a first sample far from it is bad

  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::vector<double> samples = {500, 501, nan, 502, 1023, 503, 35512.6, 504, 900, 505, 506};
  for (const double counts : samples) {
    const gc::Command command = controller.Step({.counts = {&counts, 1}});
    std::printf("%9.1f -> %4d\n", counts, command.motor_counts[0]);
    if (command.motor_counts[0] < 440 || command.motor_counts[0] > 460) return 1;
  }
  controller.Step({.counts = {}});  // a frame that did not arrive
  std::printf("%lld untrusted, of them %lld missing, %lld jumped\n",
              static_cast<long long>(controller.untrusted_samples()[0]),
              static_cast<long long>(controller.untrusted_samples(gc::Untrusted::kMissing)[0]),
              static_cast<long long>(controller.untrusted_samples(gc::Untrusted::kJumped)[0]));
  return controller.untrusted_samples()[0] == 5 ? 0 : 1;
}
