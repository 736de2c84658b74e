#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "controller/controller.h"
#include "controller/filters/filter.h"
#include "controller/linearisation/linearisation.h"
#include "controller/motor_rounding.h"
#include "controller/tendon_map.h"

namespace gauntlet::controller {

/// The stages of a controller and what flows between them.
struct Controller::State {
  explicit State(const RobotConfig& robot_in);

  void TakeSample(const GloveSample& sample) noexcept;
  Command StepEvent() noexcept;
  void StartChannel(int channel) noexcept;
  void StepFilters() noexcept;
  void HoldInactiveChannels() noexcept;
  void StepMotors() noexcept;
  void Reset() noexcept;
  /// Goes on where `before`, a controller of the same glove and hand, stands.
  void TakeOver(const State& before) noexcept;

  RobotConfig robot;
  std::unique_ptr<Linearisation> linearisation;
  JointMap joint_map;
  SampleGuard guard;
  std::vector<std::unique_ptr<Filter>> chain;
  std::unique_ptr<Filter> predictor;  // may be null
  TendonMap tendon_map;
  MotorRounding rounding;

  PeriodicClock event_clock;
  std::vector<std::uint8_t> active;  // per channel
  int inactive_count = 0;
  std::vector<double> linearised_rad;
  std::vector<double> filtered_counts;
  std::vector<double> filtered_rad;
  std::vector<double> predicted_rad;
  std::vector<double> held_rad;    // in place of what is predicted for inactive channels
  std::vector<double> target_rad;  // per joint
  std::vector<double> exact_motor_counts;
  std::vector<std::int32_t> motor_counts;
};

}  // namespace gauntlet::controller
