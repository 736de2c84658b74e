#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "controller/controller.h"
#include "sim/hand/hand.h"
#include "sim/hand/joint_sensors.h"
#include "sim/loop/event_link.h"

namespace gauntlet::sim {

/// Controller, link and hand as one: glove samples in, a moving hand out. The same loop runs in
/// trials and live; who calls Step() owns the time.
///
///     sample -> controller -> (event) -> link -> (delay) -> servos, cables, joints
///                   ^---------- (delay) <- joint sensors, if there are any <----|
class HandLoop {
 public:
  /// The clocks are those of `hand`. Errors: SettingError of the controller.
  HandLoop(const controller::ControllerConfig& config, const controller::GloveCalibration& glove,
           const controller::JointMapConfig& joint_map, std::shared_ptr<const HandModel> hand);

  /// Controller as new and told where the motors are, nothing on its way, the hand at rest in this
  /// posture [rad, per joint].
  void Reset(std::span<const double> joint_angle_rad);

  /// One tick, with a new sample of the glove or without one. Neither throws nor allocates. Once
  /// the hand's health is bad nothing happens any more.
  void Step(const controller::GloveSample& sample) noexcept;
  void Step() noexcept;

  const controller::Controller& controller() const noexcept { return controller_; }
  const Hand& hand() const noexcept { return hand_; }
  /// What the joint sensors said last, as the controller has it; NaN before their first reading,
  /// empty without them. Shape: one per joint. Units: rad.
  std::span<const double> measured_angle_rad() const noexcept { return measured_angle_rad_; }

 private:
  void ReadSensors() noexcept;
  void Advance(const controller::Command& command) noexcept;

  controller::Controller controller_;
  EventLink link_;
  Hand hand_;
  JointSensors sensors_;
  std::vector<double> joint_angle_rad_;
  std::vector<double> measured_angle_rad_;
  std::int64_t tick_ = 0;
};

}  // namespace gauntlet::sim
