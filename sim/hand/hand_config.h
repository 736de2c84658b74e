#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "controller/settings.h"
#include "sim/hand/servo_config.h"

namespace gauntlet::sim {

enum class JointSensorsKind { kNone, kEncoder };

/// Sensors of the hand's joints. Source of resolution and noise: ams AS5600, a magnetic encoder
/// of 12 bits a turn, data sheet v1-06: 0.043 deg RMS with its fastest filter. Rate: that of the
/// joint loop of orcahand/orca_core PR #83; the delay on the bus is an assumption.
struct JointSensorsConfig {
  JointSensorsKind kind = JointSensorsKind::kNone;
  int resolution_bits = 12;
  double noise_deg = 0.043;  // standard deviation
  double rate_hz = 100.0;
  double delay_ms = 5.0;

  void Visit(controller::SettingsVisitor& visitor);
};

/// Properties of the two cables of every motor. Stiffness and damping of each cable stand in the
/// model file; here stands what is common, and what can be switched off to see what it does.
struct CableConfig {
  double stiffness_scale = 1.0;  // on the stiffness of the model
  double stiffness_n_m = 0.0;    // of cables to which the model gives none
  double pretension_mm = 0.4;    // both cables are this much too short, if as stiff as the model's
  std::vector<double> slack_mm = {0.0};  // and this much too long: for all motors, or for each
  double capstan_friction = 0.04;        // coefficient of friction on pulleys and guides; 0 is off
  double backlash_deg = 0.0;             // play of the drum on the motor's shaft, end to end

  void Visit(controller::SettingsVisitor& visitor);
};

/// How far the hand as it was built is off its model, which is what the controller knows: standard
/// deviations of normal errors. It is one hand: its seed is not that of the noise.
struct AssemblyErrorConfig {
  int seed = 1;
  double drum_radius_percent = 0.0;
  double moment_arm_percent = 0.0;
  double centre_deg = 0.0;

  void Visit(controller::SettingsVisitor& visitor);
};

/// Motor data that a model may lack: for all motors, or for each. Empty: as in the model.
struct MotorConfig {
  std::vector<double> stall_torque_nm;
  std::vector<double> rotor_inertia_kg_m2;  // behind its gear
  std::vector<double> dry_friction_nm;      // of its gear
  std::vector<double> drum_radius_mm;       // of a motor that pulls a tendon without a drum
  double windup_deg = 1.0;  // of a motor without cables, at its stall torque; see Shaft

  void Visit(controller::SettingsVisitor& visitor);
};

/// Contacts to compute. They cost time, so they are off where they are not needed.
enum class Contact {
  kNone,    // bodies pass through each other
  kHand,    // palm, thumb and fingers touch each other
  kObject,  // and a cylinder that stands on a support in front of the palm
};

/// The cylinder to grasp.
struct ObjectConfig {
  double mass_kg = 0.3;
  double diameter_mm = 44.0;
  double friction = 1.0;  // of its surface on the hand, rubber on plastic: an assumption

  void Visit(controller::SettingsVisitor& visitor);
};

/// The simulated hand and arm, as far as a person chooses.
struct HandConfig {
  std::string model_path;  // an MJCF file; empty: models/hand_arm.xml of the project
  double step_ms = 1.0;    // of the physics engine, at most; see LoopTiming
  ServoConfig servo;
  ServoConfig arm_servo{.settings = MxServo{}};  // no servo for fingers turns an elbow
  /// On all friction of a motor: dry_friction and load_friction of its spool, capstan_friction of
  /// its cables. One for all motors, or one for each in the model's order.
  std::vector<double> motor_friction_scale = {1.0};
  MotorConfig motor;
  bool motor_limits = true;  // off: motors have any torque and speed, to see what the limits do
  CableConfig cable;
  AssemblyErrorConfig assembly_error;
  JointSensorsConfig joint_sensors;
  Contact contact = Contact::kNone;
  ObjectConfig object;

  /// A servo and the key of its settings.
  struct KeyedServo {
    std::string_view key;
    const ServoNumbers& numbers;
  };
  /// That of a motor with this stall torque in the model's file: beyond 5 N m it is `arm_servo`.
  KeyedServo ServoOf(double stall_torque_nm) const;
  void Visit(controller::SettingsVisitor& visitor);
};

}  // namespace gauntlet::sim
