#pragma once

#include <string>

#include "controller/settings.h"
#include "sim/hand/joint_sensors_config.h"
#include "sim/hand/servo_config.h"

namespace gauntlet::sim {

/// What the two cables of every motor are like. Stiffness and damping of each cable stand in the
/// model file; here stands what is common, and what can be switched off to see what it does.
struct CableConfig {
  bool stretch = true;           // off: 8 times as stiff, about what the time step can bear
  double stiffness_scale = 1.0;  // on the stiffness of the model
  double pretension_mm = 0.4;    // both cables are this much too short, if as stiff as the model's
  double slack_mm = 0.0;         // and this much too long
  double capstan_friction = 0.03;  // coefficient of friction on pulleys and guides; 0 is off
  double backlash_deg = 0.0;       // play of the drum on the motor's shaft, end to end
  bool interference = true;        // off: cables cross other joints without moving them

  void Visit(controller::SettingsVisitor& visitor);
};

/// What touches what. Contacts cost time, so they are off where they are not needed.
enum class Contact {
  kNone,    // bodies pass through each other
  kHand,    // thumb and palm touch fingers and each other; fingers do not touch fingers
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
  CableConfig cable;
  JointSensorsConfig joint_sensors;
  Contact contact = Contact::kNone;
  ObjectConfig object;

  void Visit(controller::SettingsVisitor& visitor);
};

}  // namespace gauntlet::sim
