#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "controller/angle_estimator.h"
#include "controller/controller.h"
#include "controller/glove_watch.h"
#include "controller/joint_loop.h"
#include "controller/loop_watch.h"
#include "controller/model_predictive/model_predictive.h"
#include "controller/motor_rounding.h"
#include "controller/periodic_clock.h"
#include "controller/sample_guard.h"
#include "controller/tendon_map.h"

namespace gauntlet::controller {

/// Connections of a controller, owned by its states and by those that are prepared for it.
struct __attribute__((visibility("hidden"))) Controller::Robot
    : public std::enable_shared_from_this<Robot> {
  explicit Robot(const RobotConfig& connections) : config(connections) {}

  const RobotConfig config;
};

/// The stages of a controller and what flows between them.
struct __attribute__((visibility("hidden"))) Controller::State {
  /// State for the robot of `connected_to`, controlled as `config` says.
  State(std::shared_ptr<const Robot> connected_to, const ControllerConfig& config)
      : State(connected_to->config, config) {
    robot = std::move(connected_to);
  }

  /// A tick, with a sample or without one (null).
  Command Step(const GloveSample* sample) noexcept;
  void AcceptSample(const GloveSample& sample) noexcept;
  GloveStatus Status() const noexcept;
  void MoveLostChannels() noexcept;
  bool StepEvent() noexcept;
  void StepFilters() noexcept { estimator.StepLinearised(guard.trusted_counts(), linearised_rad); }
  void PlanCommands() noexcept;
  void Reset() noexcept;
  void Reset(std::span<const std::int32_t> at_counts) noexcept;
  /// Goes on where `before`, a controller of the same glove and hand, stands. The memory of what
  /// can be read from outside comes along.
  void SwapMemory(State& before) noexcept;

  std::shared_ptr<const Robot> robot;  // never changes

  // Chosen stages and settings.
  FilterAt filter_at;
  JointMap joint_map;
  SampleGuard guard;
  GloveWatch watch;
  LoopWatch loop;
  TendonMap tendon_map;
  ModelPredictive model_predictive;
  AngleEstimator estimator;
  JointLoop joint_loop;
  MotorRounding rounding;
  WhenLost when_lost;
  double lost_step_rad;          // that a lost channel moves per event
  std::vector<double> rest_rad;  // per channel, of the reference posture

  // Signals between the stages.
  bool judged = false;  // the last tick had a sample, or one was overdue
  PeriodicClock event_clock;
  std::vector<double> linearised_rad;  // per channel, not filtered
  std::vector<double> start_counts;    // of the guard
  std::vector<std::uint8_t> lost;      // per channel
  std::vector<double> lost_rad;        // where a lost channel is
  std::vector<double> target_rad;      // per joint
  std::vector<double> path_rad;        // the rows of the estimator's path, per joint
  std::vector<double> planned_rad;
  std::vector<double> corrected_rad;
  std::vector<double> sent_rad;  // what the motors were told, per joint
  std::vector<double> exact_motor_counts;
  std::vector<std::int32_t> motor_counts;

 private:
  State(const RobotConfig& connected_to, const ControllerConfig& config);
};

}  // namespace gauntlet::controller
