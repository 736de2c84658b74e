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
  double reference_rad = 0.0;  // joint angle for which the next three hold
  double moment_arm_m = 0.0;   // how the cable's length grows with the joint's angle
  double arm_error_m = 0.0;    // in it, and not in the model
  double bend_rad = 0.0;       // how far the cable has bent from the drum to behind this joint
  double bend_per_rad = 0.0;   // how that grows with this joint's angle: +1 or -1
  int branch = 0;              // of the cable
};

/// A part of a cable between pulleys of the model, or a whole one. A floating pulley divides a
/// cable into branches that pull alike.
struct CableBranch {
  int parent = -1;        // branch that it goes on; -1: it begins at the drum
  double bend_rad = 0.0;  // from the drum to its end at the reference
};

/// Position in qpos of what a joint turns with: the joint itself, or the one that leads it.
struct Leading {
  int qpos = 0;
  double slope = 1.0;  // d joint / d leading joint
};
/// Leading joint of the joint with this position in qpos.
Leading LeadingOf(int qpos, const std::vector<Follower>& followers);

/// A cable from its drum to the joints that it moves.
struct Cable {
  std::string name;
  double sense = 1.0;  // 1: a flexor, wound up by a positive spool angle; -1: an extensor, paid out
  int tendon = 0;
  Cord cord;
  double pretension_n = 0.0;
  double natural_length_m = 0.0;  // beyond the drum, with the spool at 0
  std::vector<CableBranch> branches;
  std::vector<Crossing> crossings;
  // Length beyond the drum = fixed length + sum of spans; none if the engine has to measure it.
  double fixed_length_m = 0.0;
  std::vector<CableSpan> spans;

  /// True if the way from the drum to the end of a branch contains another, or is that one.
  bool Contains(int branch, int other) const;
};

/// A joint that a motor turns without cables.
struct ShaftJoint {
  std::string name;
  int dof = 0;
  int qpos = 0;
  double ratio = 1.0;          // d shaft / d joint
  double reference_rad = 0.0;  // joint angle at which the shaft stands at 0
};

/// Connection of a motor to its joints without cables: its gear, and bars or belts of fixed ratio.
/// It turns by
///
///     shaft = sum over joints of ratio (joint - reference), less zero error
///
/// and carries the torque of a spring and a damper between spool and shaft, beyond the play:
///
///     torque = CableTension() of the twist, in both directions; ratio times it at each joint
///
/// With one joint of ratio 1 this is direct drive. With several it moves their sum, and their own
/// springs and loads decide on the shares. The stiffness stands for the gear's: an STS3215 with
/// 1.5 kg on an arm of 10 cm is 1.8 to 2.6 deg off, its play of 1 deg included
/// (TheRobotStudio/SO-ARM100, issue 134), which is 40 N m/rad or more. Damping of 1 ms times the
/// stiffness is an assumption.
struct Shaft {
  double stiffness_nm_rad = 0.0;
  double damping_nm_s_rad = 0.0;
  double zero_error_rad = 0.0;
  std::vector<ShaftJoint> joints;
};

/// A motor: servo, spool, and either cables (a flexor and, unless springs pull back, an extensor)
/// or a shaft.
struct Drive {
  std::string name;
  int spool_qpos = -1;  // -1: the model has no spool
  int spool_dof = -1;
  int pulled_tendon = -1;  // of a motor that pulls a tendon without a spool
  double drum_radius_m = 0.0;
  double play_rad = 0.0;       // between the spool and the drum or the shaft, end to end
  std::string_view servo_key;  // of its settings in a scenario
  ServoNumbers numbers;
  Servo servo;
  Spool spool;
  std::vector<Cable> cables;
  Shaft shaft;  // without joints where there are cables

  bool has_shaft() const { return !shaft.joints.empty(); }
};

/// How a motor moves its joints.
enum class Transmission { kCables, kDirect, kLinkage };
Transmission TransmissionOf(const Drive& drive);

/// Motor as the model describes its actuator; 0 for values that it does not state.
struct MotorInModel {
  std::string name;
  bool has_spool = false;  // a part is called NAME_spool, NAME_drum, NAME_flexor or NAME_extensor
  int joint = -1;          // that it turns without cables
  int tendon = -1;         // a tendon that it pulls, or one of joints that it turns
  bool pulls_cable = false;
  double drum_radius_m = 0.0;    // of a motor that pulls a cable by its own angle; 0: not known
  double stall_torque_nm = 0.0;  // of a motor that pulls a cable: its force [N]
  double rotor_inertia_kg_m2 = 0.0;
  double dry_friction_nm = 0.0;
};
/// In the model's order. Stall torque: the ctrlrange of a <motor>, else the forcerange, times the
/// gear. Drum: of an actuator that holds the length of its cable at a multiple of its control, as
/// gauntlet export writes them; where the multiple is 1, the control is a length. Rotor and
/// friction: armature and frictionloss of the joint; of several joints, the mean of armature /
/// ratio^2 and no friction, which stays with the joints. Errors: UserError for an actuator without
/// a name, or on something else than joints and tendons.
std::vector<MotorInModel> MotorsInModel(const mjModel_& model);

/// All motors of the model, in its order, without their cables' paths and the references of their
/// shafts: actuator NAME on the spool joint NAME_spool with the drum NAME_drum; or on a joint, or a
/// tendon of joints, that it turns without cables; or on a spatial tendon that it pulls.
/// Takes armature and friction of joints that a motor turns alone out of the model: the motor has
/// them.
/// Errors: UserError that names what the model lacks.
std::vector<Drive> FindDrives(mjModel_& model, const HandConfig& config);

/// Gives the shafts their references: the joints in the middle of their ranges.
/// Errors: UserError for a joint that can be turned by no motor.
void PlaceShafts(const mjModel_& model, const std::vector<HandJoint>& joints,
                 const std::vector<Follower>& followers, std::vector<Drive>& drives);

/// The motor that is made for a joint: of its name, or that turns it alone without cables.
const Drive* OwnDrive(const HandJoint& joint, const std::vector<Drive>& drives);

/// Gives the drives without a shaft their cables: the tendon NAME_flexor and, if there is one,
/// NAME_extensor, or the tendon that it pulls, with the joints on their way, a part of `joints`.
/// Errors: UserError that names what the model lacks.
void FindCables(const mjModel_& model, const HandConfig& config,
                const std::vector<HandJoint>& joints, const std::vector<Follower>& followers,
                std::vector<Drive>& drives);

/// The value of one motor in a list of one for all motors, or one for each; not of an empty list.
double OfMotor(const std::vector<double>& values, std::size_t motor) noexcept;

/// How a cable's length grows with a joint's angle, here and now [m/rad].
double MomentArm(const mjModel_& model, const mjData_& data, int tendon, int dof) noexcept;

/// Index of a named part of the model, `type` an mjtObj; UserError with the nearest name if there
/// is none.
int FindInModel(const mjModel_& model, int type, const std::string& name);

}  // namespace gauntlet::sim
