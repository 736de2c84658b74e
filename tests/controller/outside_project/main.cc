#include <cstdint>
#include <cstdio>
#include <vector>

#include "controller/calibration/curve_fit.h"
#include "controller/calibration/noise_estimate.h"
#include "controller/controller.h"
#include "controller/filters/filter_registry.h"
#include "controller/robot_text.h"
#include "controller/step_recorder.h"

int main() {
  namespace gc = gauntlet::controller;
  const gc::GloveCalibration glove = {.channel_names = {"a", "b"},
                                      .low_counts = {200, 200},
                                      .high_counts = {800, 800},
                                      .low_angle_rad = {0, 0},
                                      .high_angle_rad = {1.5, 1.5}};
  const gc::TendonTransmission hand = {.joint_names = {"a", "b"},
                                       .motor_names = {"a", "b"},
                                       .coupling = {1, 0, 0.5, 1},
                                       .reference_angle_rad = {0, 0},
                                       .joint_min_rad = {0, 0},
                                       .joint_max_rad = {1.5, 1.5},
                                       .counts_per_rad = {100, 100},
                                       .center_counts = {512, 512},
                                       .min_counts = {0, 0},
                                       .max_counts = {1023, 1023}};
  gc::ControllerConfig config;
  config.filters = {{gc::KalmanConfig{.noise = {.r = {10.0}}}}};
  gc::Controller controller(config, glove, hand);
  controller.Reset(std::vector<std::int32_t>{555, 620});  // where the motors are
  const double counts[] = {400.0, 600.0};
  const gc::Command command = controller.Step({.counts = counts});
  gc::StepRecorder recorder({config, glove, hand, {}, {}}, 5);
  if (!recorder.Add({.counts = counts}, controller, command) || recorder.size() != 1) return 1;
  // Values of another shape: nothing is done, and nothing ends the program.
  std::vector<double> three(3, 7.0);
  const auto filter = gc::MakeFilter({gc::KalmanConfig{.noise = {.r = {10.0}}}}, 2, 1000.0);
  filter->Step(three, three);
  filter->ResetChannel(2);
  if (three != std::vector<double>(3, 7.0)) return 1;
  // 0.5 and 1.0 rad: 512 + 100 * 0.5, and 512 + 100 (0.5 * 0.5 + 1.0).
  std::printf("%d %d\n", command.motor_counts[0], command.motor_counts[1]);
  return command.motor_counts[0] == 562 && command.motor_counts[1] == 637 ? 0 : 1;
}
