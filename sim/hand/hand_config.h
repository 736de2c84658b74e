#pragma once

#include <string>

#include "controller/settings.h"

namespace gauntlet::sim {

/// A position servo on a spool. The same for all motors; stall torques stand in the model file,
/// since a shoulder needs another motor than a finger.
///
/// Source of the defaults: a standard 10-bit RC servo (300 deg of travel, 0.15 s per 60 deg, one
/// frame per 20 ms); dead band, gain and damping are assumptions (models/README.md).
struct ServoConfig {
  int resolution_bits = 10;            // the command has 2^bits steps over the travel
  double travel_deg = 300.0;           // of the spool, end to end
  double frame_ms = 20.0;              // a new command is taken only at a frame; 0: at once
  double dead_band_deg = 0.2;          // errors up to this cause no torque, to either side
  double full_torque_error_deg = 1.5;  // gain: error beyond the dead band for the stall torque
  double damping_ms = 12.0;            // speed that is braked as much as an error is pulled
  double no_load_speed_deg_s = 400.0;  // back-EMF: torque falls linearly to zero at this speed
  double torque_scale = 1.0;           // on the stall torques of the model

  void Visit(controller::SettingsVisitor& visitor);
};

/// What the two cables of every motor are like. Stiffness and damping of each cable stand in the
/// model file; here stands what is common, and what can be switched off to see what it does.
struct CableConfig {
  bool stretch = true;             // off: 8 times as stiff, about what the time step can bear
  double stiffness_scale = 1.0;    // on the stiffness of the model
  double pretension_mm = 0.4;      // both cables of a motor are this much too short
  double slack_mm = 0.0;           // and this much too long
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
  Contact contact = Contact::kNone;
  ObjectConfig object;

  void Visit(controller::SettingsVisitor& visitor);
};

}  // namespace gauntlet::sim
