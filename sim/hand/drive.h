#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "sim/hand/cable.h"
#include "sim/hand/cable_span.h"
#include "sim/hand/engine_types.h"
#include "sim/hand/follower.h"
#include "sim/hand/hand_config.h"
#include "sim/hand/hand_joint.h"
#include "sim/hand/servo.h"
#include "sim/hand/spool.h"

namespace gauntlet::sim {

/// A joint that a cable passes on its way, in the order from the drum.
struct Crossing {
  int dof = 0;
  int qpos = 0;
  bool own = false;            // the cable is meant to move this joint, or one that it follows
  double reference_rad = 0.0;  // joint angle for which the next three hold
  double moment_arm_m = 0.0;   // how the cable's length grows with the joint's angle
  double arm_error_m = 0.0;    // in it, and not in the model
  double bend_rad = 0.0;       // how far the cable has bent from the drum to behind this joint
  double bend_per_rad = 0.0;   // how that grows with this joint's angle: +1 or -1
};

/// Position in qpos of what a crossing turns with: the joint itself, or the one that leads it.
struct Leading {
  int qpos = 0;
  double slope = 1.0;  // d crossed joint / d leading joint
};
Leading LeadingOf(const Crossing& crossing, const std::vector<Follower>& followers);

/// A cable from its drum to the joints that it moves.
struct Cable {
  std::string name;
  double sense = 1.0;  // 1: a flexor, wound up by a positive spool angle; -1: an extensor, paid out
  int tendon = 0;
  Cord cord;
  CableWear wear;
  double pretension_n = 0.0;
  double natural_length_m = 0.0;  // beyond the drum, with the spool at 0
  double bend_rad = 0.0;          // the whole of it at the reference
  std::vector<Crossing> crossings;
  // Length beyond the drum = fixed length + sum of spans; none if the engine has to measure it.
  double fixed_length_m = 0.0;
  std::vector<CableSpan> spans;
};

/// A motor: servo, spool and its cables, a flexor and, unless springs pull back, an extensor.
struct Drive {
  std::string name;
  int spool_qpos = 0;
  int spool_dof = 0;
  double drum_radius_m = 0.0;
  double play_rad = 0.0;       // between the spool's shaft and the drum, end to end
  std::string_view servo_key;  // of its settings in a scenario
  ServoNumbers numbers;
  Servo servo;
  Spool spool;
  std::vector<Cable> cables;
};

/// All motors of the model, in its order, without their cables' paths: actuator NAME on the spool
/// joint NAME_spool with the drum NAME_drum.
/// Errors: UserError that names what the model lacks.
std::vector<Drive> FindDrives(const mjModel_& model, const HandConfig& config);

/// Gives the drives their cables: the tendon NAME_flexor and, if there is one, NAME_extensor, with
/// the joints that they pass. `joints` are all that may be among them.
/// Errors: UserError that names what the model lacks.
void FindCables(const mjModel_& model, const HandConfig& config,
                const std::vector<HandJoint>& joints, const std::vector<Follower>& followers,
                std::vector<Drive>& drives);

/// The value of one motor in a list of one for all motors, or one for each.
double OfMotor(const std::vector<double>& values, std::size_t motor) noexcept;

/// How a cable's length grows with a joint's angle, here and now [m/rad].
double MomentArm(const mjModel_& model, const mjData_& data, int tendon, int dof) noexcept;

/// Index of a named part of the model, `type` an mjtObj; UserError with the nearest name if there
/// is none.
int FindInModel(const mjModel_& model, int type, const std::string& name);

}  // namespace gauntlet::sim
