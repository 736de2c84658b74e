#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "sim/hand/hand_model.h"

namespace gauntlet::sim {

/// How a simulated hand is: well, or stopped by a warning of the physics engine or a divergence.
struct HandHealth {
  bool ok = true;
  std::string problem;  // "at 1.234 s: bad value in qacc (dof 12)"
};

/// One hand in motion. One per thread; all share a HandModel.
class Hand {
 public:
  explicit Hand(std::shared_ptr<const HandModel> model);
  ~Hand();
  Hand(const Hand&) = delete;
  Hand& operator=(const Hand&) = delete;

  /// At rest in the given posture [rad, per joint], clamped to the ranges, cables consistent.
  void Reset(std::span<const double> joint_angle_rad);
  /// The command frame that the servos hold from now on [counts, per motor].
  void SetCommand(std::span<const std::int32_t> motor_counts) noexcept;
  /// Switches the torque of the motors; it is on after Reset(). Without it spools turn freely, but
  /// for the gear's friction.
  void SetPower(bool on) noexcept;
  /// The frame that the servos hold; after Reset() the one that keeps the posture.
  std::span<const std::int32_t> command() const noexcept;
  /// One tick of the model's timing. Reads every warning counter. Once health is bad it does
  /// nothing, and what is read below is no state of the hand any more.
  void Step() noexcept;

  // Per joint, motor or cable, after the last Step() or Reset().
  void ReadJointAngles(std::span<double> joint_angle_rad) const noexcept;
  void ReadSpoolAngles(std::span<double> spool_angle_rad) const noexcept;
  void ReadSpoolSpeeds(std::span<double> spool_speed_rad_s) const noexcept;
  /// Torque of each servo on its spool [N m], of which the gear's friction took its part.
  void ReadServoTorques(std::span<double> torque_nm) const noexcept;
  void ReadCableTensions(std::span<double> tension_n) const noexcept;
  /// Energy that all cables can give back, when the last step began [J].
  double CableEnergy() const noexcept;
  /// Sum of the normal forces between hand and object [N]; 0 without one.
  double GripForce() const noexcept { return Forces().grip_n; }
  /// Forces on the object; 0 without one.
  ObjectForces Forces() const noexcept;
  /// The deepest interpenetration of two digits [m], every 10 ms; 0 without digits.
  double DigitOverlap() const noexcept;
  /// Position [m] and attitude (quaternion) of the object in the world, 7 values; without an object
  /// nothing is written.
  void ReadObjectPose(std::span<double> pose) const noexcept;
  /// Pose of the object in the frame of the palm, when the last step began.
  void ReadObjectInPalm(std::span<double> pose) const noexcept;
  /// Velocity of the palm in the world [m/s], 3 values, when the last step began; nothing is
  /// written where it stands still.
  void ReadPalmVelocity(std::span<double> velocity_m_s) const noexcept;
  /// True per motor while the servo is at its torque limit.
  void ReadSaturation(std::span<std::uint8_t> saturated) const noexcept;
  const HandHealth& health() const noexcept;

  const HandModel& hand_model() const noexcept;
  /// State of the engine for the physics model.
  const mjData_& data() const noexcept;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace gauntlet::sim
