// Read samples, step, get integer commands: all that a robot's control loop needs.

#include <cmath>
#include <cstdio>
#include <vector>

#include "controller/controller.h"

namespace gc = gauntlet::controller;

int main() {
  // What the controller is connected to: a glove with two bending sensors, known in two poses ...
  const gc::GloveCalibration glove = {.channel_names = {"mcp", "pip"},
                                      .low_counts = {200, 230},
                                      .high_counts = {800, 760},
                                      .low_angle_rad = {0.0, 0.0},
                                      .high_angle_rad = {1.5, 1.6}};
  // ... and a finger of two joints. The cable of the second joint crosses the first, so that its
  // spool must turn by 0.6 rad for each rad of the first joint.
  const gc::TendonTransmission finger = {.joint_names = {"mcp", "pip"},
                                         .motor_names = {"mcp", "pip"},
                                         .coupling = {1.0, 0.0, 0.6, 1.0},
                                         .reference_angle_rad = {0.0, 0.0},
                                         .joint_min_rad = {0.0, 0.0},
                                         .joint_max_rad = {1.5, 1.6},
                                         .counts_per_rad = {195.0, 195.0},
                                         .center_counts = {300, 300},
                                         .min_counts = {0, 0},
                                         .max_counts = {1023, 1023}};
  // What it does: the paper's filter on the counts, one command frame every 20 samples of 1 ms.
  gc::ControllerConfig config;
  config.filters = {{gc::KalmanConfig{.noise = {.r = {21.18, 12.52}, .q = {1e-3}}}}};
  gc::Controller controller(config, glove, finger);

  for (int k = 0; k < 1000; ++k) {
    const double bend =
        0.5 - 0.5 * std::cos(2.0 * 3.14159265 * k / 1000.0);  // read your glove here
    const std::vector<double> counts = {std::round(200 + 600 * bend), std::round(230 + 530 * bend)};
    const gc::Command command = controller.Step({.counts = counts});
    if (k % 100 == 0) {  // send to your motors here
      std::printf("%4d ms  %4d %4d\n", k, command.motor_counts[0], command.motor_counts[1]);
    }
  }
  return 0;
}
