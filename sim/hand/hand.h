#pragma once

#include <mujoco/mujoco.h>

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "controller/controller_config.h"
#include "sim/hand/drive.h"
#include "sim/hand/grasp.h"
#include "sim/hand/hand_config.h"

namespace gauntlet::sim {

/// The hand and arm as one compiled, const model, shared by all threads of a comparison.
///
/// Channels, motors and cables are looked up by name once, here. A channel is the joint of the same
/// name; its motor is the spool joint `<channel>_spool`; cables are the tendons `<channel>_flexor`
/// and `<channel>_extensor`.
/// Errors: UserError for settings that the model cannot take.
class HandModel {
 public:
  HandModel(const HandConfig& config, const std::vector<std::string>& channel_names);
  HandModel(const HandModel&) = delete;
  HandModel& operator=(const HandModel&) = delete;

  const mjModel& model() const { return *model_; }
  const HandConfig& config() const { return config_; }
  /// What a controller must know of this hand: coupling, ranges, counts.
  const controller::TendonTransmission& transmission() const { return transmission_; }
  /// Motors with their spools and cables, in the order of the channels.
  const std::vector<Drive>& drives() const { return drives_; }
  const GraspParts& grasp() const { return grasp_; }
  /// Flexor and extensor of every motor.
  const std::vector<std::string>& cable_names() const { return cable_names_; }
  /// Of the compiled model and everything that shapes it, for `scenario.resolved.yaml`.
  std::string Hash() const;
  /// Of MuJoCo, as "2.2.2".
  static std::string EngineVersion();

 private:
  friend class Hand;
  friend void SetPosture(const HandModel&, std::span<const double>, std::span<const double>,
                         mjData&);
  HandConfig config_;
  std::unique_ptr<mjModel, void (*)(mjModel*)> model_;
  std::vector<int> channel_qpos_;
  std::vector<Follower> followers_;
  std::vector<Drive> drives_;
  GraspParts grasp_;
  std::vector<std::string> cable_names_;
  controller::TendonTransmission transmission_;
  int steps_per_sample_ = 1;
};

/// How a simulated hand is: well, or stopped by a warning of the physics engine or a divergence.
struct HandHealth {
  bool ok = true;
  std::string problem;  // "at 1.234 s: bad value in qacc (dof 12)"
};

/// How the hand holds the object; all zero without one.
struct GripReading {
  double force_n = 0.0;    // sum of the contacts' normal forces between hand and object
  double height_mm = 0.0;  // of the object above where it stood
  double slip_mm_s = 0.0;  // speed of the object against the palm
};

/// One hand in motion. One per thread; all share a HandModel.
class Hand {
 public:
  explicit Hand(std::shared_ptr<const HandModel> model);
  ~Hand();
  Hand(const Hand&) = delete;
  Hand& operator=(const Hand&) = delete;

  /// At rest in the given posture [rad, per channel], clamped to the ranges, cables consistent.
  void Reset(std::span<const double> joint_angle_rad);
  /// The command frame that the servos hold from now on [counts, per motor].
  void SetCommand(std::span<const std::int32_t> motor_counts) noexcept;
  /// The frame that the servos hold; after Reset() the one that keeps the posture.
  std::span<const std::int32_t> command() const noexcept;
  /// One sampling period (1 ms). Reads every warning counter. Once health is bad it does nothing,
  /// and what is read below is no state of the hand any more.
  void Step() noexcept;

  // Per channel, motor or cable, after the last Step() or Reset().
  void ReadJointAngles(std::span<double> joint_angle_rad) const noexcept;
  void ReadSpoolAngles(std::span<double> spool_angle_rad) const noexcept;
  void ReadSpoolSpeeds(std::span<double> spool_speed_rad_s) const noexcept;
  void ReadCableTensions(std::span<double> tension_n) const noexcept;
  GripReading ReadGrip() const noexcept;
  /// Position [m] and attitude (quaternion) of the object in the world, 7 values; without an object
  /// nothing is written.
  void ReadObjectPose(std::span<double> pose) const noexcept;
  /// True per motor while the servo gives all the torque it has.
  void ReadSaturation(std::span<std::uint8_t> saturated) const noexcept;
  const HandHealth& health() const noexcept;

  const HandModel& hand_model() const noexcept;
  /// For drawing only.
  const mjData& data() const noexcept;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Joint positions for drawing a recorded posture: fills the full qpos of `data` from the joint
/// angles [rad, per channel] and spool angles [rad, per motor] (coupled joints follow) and computes
/// where everything is.
void SetPosture(const HandModel& model, std::span<const double> joint_angle_rad,
                std::span<const double> spool_angle_rad, mjData& data);

/// Puts the object where it was, for drawing; call SetPosture() afterwards. Without an object
/// nothing happens.
void SetObjectPose(const HandModel& model, std::span<const double> pose, mjData& data);

/// From now on errors and warnings of the physics engine become exceptions and health reports; no
/// MUJOCO_LOG.TXT is written. Called by HandModel; safe to call twice.
void TakeOverMujocoMessages();

}  // namespace gauntlet::sim
