#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "controller/controller.h"
#include "controller/filters/filter.h"
#include "controller/joint_loop.h"
#include "controller/linearisation/linearisation.h"
#include "controller/model_predictive/model_predictive.h"
#include "controller/motor_rounding.h"
#include "controller/prediction/motion_path.h"
#include "controller/tendon_map.h"

namespace gauntlet::controller {

/// The stages of a controller and what flows between them.
struct Controller::State {
  /// What `robot` is connected to, controlled as `config` says.
  State(const RobotConfig& robot, const ControllerConfig& config);

  void TakeSample(const GloveSample& sample) noexcept;
  Command StepEvent() noexcept;
  void StartChannel(int channel) noexcept;
  void StepFilters() noexcept;
  void PlanCommands() noexcept;
  void HoldInactiveChannels() noexcept;
  void SetChannelActive(int channel, bool active) noexcept;
  void Reset() noexcept;
  void Reset(std::span<const std::int32_t> at_counts) noexcept;
  /// Goes on where `before`, a controller of the same glove and hand, stands. The memory of what
  /// can be read from outside comes along.
  void TakeOver(State& before) noexcept;

  // What was chosen.
  FilterOn filter_on;
  FilterAt filter_at;
  double step_rate_hz;  // of filters and prediction
  std::unique_ptr<Linearisation> linearisation;
  JointMap joint_map;
  SampleGuard guard;
  std::vector<std::unique_ptr<Filter>> chain;
  std::unique_ptr<Filter> predictor;  // may be null
  TendonMap tendon_map;
  ModelPredictive model_predictive;
  MotionPath path;  // empty where nothing is planned
  JointLoop joint_loop;
  MotorRounding rounding;

  // What flows.
  PeriodicClock event_clock;
  std::vector<std::uint8_t> active;  // per channel
  int inactive_count = 0;
  std::vector<double> middle_rad;  // per channel, between its two known poses
  std::vector<double> linearised_rad;
  std::vector<double> filtered_counts;
  std::vector<double> filtered_rad;
  std::vector<double> predicted_rad;
  std::vector<double> held_rad;    // in place of what is predicted for inactive channels
  std::vector<double> target_rad;  // per joint
  std::vector<double> path_rad;    // the rows of `path`, per joint
  std::vector<double> planned_rad;
  std::vector<double> corrected_rad;
  std::vector<double> sent_rad;  // what the motors were told, per joint
  std::vector<double> exact_motor_counts;
  std::vector<std::int32_t> motor_counts;
};

}  // namespace gauntlet::controller
