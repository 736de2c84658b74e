#include "sim/hand/drive.h"

#include <fmt/core.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>

#include "sim/base/error.h"
#include "sim/base/nearest_name.h"
#include "sim/base/signal.h"
#include "sim/hand/cable_path.h"
#include "sim/hand/firm_constraints.h"
#include "sim/hand/mujoco_versions.h"
#include "sim/hand/stability.h"

namespace gauntlet::sim {
namespace {

/// Names of all parts of one kind.
std::vector<std::string> NamesInModel(const mjModel& model, int type) {
  std::vector<std::string> names;
  for (int index = 0;; ++index) {
    const char* name = mj_id2name(&model, type, index);
    const int count = type == mjOBJ_JOINT      ? model.njnt
                      : type == mjOBJ_TENDON   ? model.ntendon
                      : type == mjOBJ_ACTUATOR ? ActuatorCount(model)
                      : type == mjOBJ_BODY     ? model.nbody
                                               : model.ngeom;
    if (index >= count) return names;
    if (name != nullptr) names.emplace_back(name);
  }
}

const char* KindName(int type) {
  switch (type) {
    case mjOBJ_JOINT:
      return "joint";
    case mjOBJ_TENDON:
      return "tendon";
    case mjOBJ_ACTUATOR:
      return "actuator";
    case mjOBJ_BODY:
      return "body";
    default:
      return "geom";
  }
}

/// `limits`: of torque and speed; without them a motor has the gain of one that is strong enough.
Servo MakeServo(ServoNumbers numbers, double stall_torque_nm, bool limits) {
  constexpr double kUnlimited = 1e3;
  if (!limits) {
    numbers.torque_scale = kUnlimited * std::max(1.0, numbers.torque_scale);
    numbers.full_torque_error_deg *= kUnlimited;
    numbers.no_load_speed_deg_s *= kUnlimited;
    numbers.current_limit_ma = 0.0;
  }
  Servo servo;
  servo.stall_torque_nm = numbers.torque_scale * stall_torque_nm;
  servo.gain_nm_rad = servo.stall_torque_nm / (numbers.full_torque_error_deg * kRadPerDeg);
  servo.damping_nm_s_rad = servo.gain_nm_rad * numbers.damping_ms * 1e-3;
  servo.dead_band_rad = numbers.dead_band_deg * kRadPerDeg;
  servo.no_load_speed_rad_s = numbers.no_load_speed_deg_s * kRadPerDeg;
  if (numbers.current_limit_ma > 0.0) {
    servo.current_share = numbers.current_limit_ma / numbers.stall_current_ma;
    servo.limits_supply = numbers.limited_current == LimitedCurrent::kSupply;
  }
  return servo;
}

/// The value of one motor that replaces the model's.
double OfMotorOr(const std::vector<double>& values, std::size_t motor, double in_model) {
  return values.empty() ? in_model : OfMotor(values, motor);
}

double RotorInertia(const HandConfig& config, const ServoNumbers& numbers, std::size_t motor,
                    const MotorInModel& in_model) {
  const double inertia =
      OfMotorOr(config.motor.rotor_inertia_kg_m2, motor, in_model.rotor_inertia_kg_m2);
  if (inertia > 0.0) return numbers.inertia_scale * inertia;
  throw UserError({.key = "hand.motor.rotor_inertia_kg_m2",
                   .problem = fmt::format("is needed: the model has no inertia of the rotor of "
                                          "motor '{}' (armature of its joint)",
                                          in_model.name)});
}

/// Rotor and gear of a motor without a spool in the model.
Spool MakeRotor(const HandConfig& config, const ServoNumbers& numbers, std::size_t motor,
                const MotorInModel& in_model) {
  return {.inertia_kg_m2 = RotorInertia(config, numbers, motor, in_model),
          .damping_nm_s_rad = 0.0,
          .dry_friction_nm = numbers.friction_scale * OfMotorOr(config.motor.dry_friction_nm, motor,
                                                                in_model.dry_friction_nm),
          .load_friction = numbers.load_friction};
}

/// That of a motor on a spool of the model.
Spool MakeSpool(const HandConfig& config, const ServoNumbers& numbers, std::size_t motor,
                const mjModel& model, int dof) {
  return {.inertia_kg_m2 = numbers.inertia_scale *
                           OfMotorOr(config.motor.rotor_inertia_kg_m2, motor, model.dof_M0[dof]),
          .damping_nm_s_rad = model.dof_damping[dof],
          .dry_friction_nm = numbers.friction_scale * OfMotorOr(config.motor.dry_friction_nm, motor,
                                                                model.dof_frictionloss[dof]),
          .load_friction = numbers.load_friction};
}

double Positive(double value, const std::string& what, const std::string& name) {
  if (value > 0.0) return value;
  throw UserError(fmt::format("{} '{}' of the model is {}: must be above 0", what, name, value));
}

/// Stiffness and damping of a tendon of the model. A motor's own tendon may have a spring that is
/// no property of the cable.
Cord MakeCord(const mjModel& model, const CableConfig& config, int tendon, const std::string& name,
              bool pulled) {
  if (!pulled) {
    const double damping = model.tendon_damping[tendon];
    if (damping < 0.0) {
      throw UserError(fmt::format("damping of tendon '{}' of the model is {}: must not be below 0",
                                  name, damping));
    }
    if (model.tendon_stiffness[tendon] > 0.0 || config.stiffness_n_m == 0.0) {
      return {
          .stiffness_n_m = Positive(model.tendon_stiffness[tendon], "stiffness of tendon", name),
          .damping_n_s_m = damping};
    }
  }
  if (config.stiffness_n_m == 0.0) {
    throw UserError({.key = "hand.cable.stiffness_n_m",
                     .problem = fmt::format("is needed: the model does not give the stiffness of "
                                            "cable '{}'",
                                            name)});
  }
  constexpr double kDampingTimeS = 1e-3;  // as the cables of models/ have it
  return {.stiffness_n_m = config.stiffness_n_m,
          .damping_n_s_m = kDampingTimeS * config.stiffness_n_m};
}

/// Everything about a cable but its path.
Cable MakeCable(const mjModel& model, const CableConfig& config, int tendon, double sense,
                bool pulled) {
  Cable cable;
  const char* const name = mj_id2name(&model, mjOBJ_TENDON, tendon);
  if (name == nullptr) throw UserError("a tendon of the model that a motor pulls has no name");
  cable.name = name;
  cable.sense = sense;
  cable.tendon = tendon;
  cable.cord = MakeCord(model, config, tendon, cable.name, pulled);
  cable.cord.stiffness_n_m *= config.stiffness_scale;
  cable.cord.friction_coefficient = config.capstan_friction;
  return cable;
}

bool HasPart(const mjModel& model, int type, const std::string& name) {
  return mj_name2id(&model, type, name.c_str()) >= 0;
}

double Larger(const mjtNum* range) { return std::max(std::abs(range[0]), std::abs(range[1])); }

/// Largest torque or force of an actuator, as far as the model says it.
double StallOf(const mjModel& model, int actuator) {
  const bool is_motor = model.actuator_gaintype[actuator] == mjGAIN_FIXED &&
                        model.actuator_biastype[actuator] == mjBIAS_NONE;
  double largest = 0.0;
  if (is_motor && model.actuator_ctrllimited[actuator]) {
    largest = std::abs(model.actuator_gainprm[mjNGAIN * actuator]) *
              Larger(model.actuator_ctrlrange + 2 * actuator);
  }
  if (model.actuator_forcelimited[actuator]) {
    const double force = Larger(model.actuator_forcerange + 2 * actuator);
    largest = largest > 0.0 ? std::min(largest, force) : force;
  }
  return largest * std::abs(model.actuator_gear[6 * actuator]);
}

/// The joints that a motor turns without cables.
std::vector<ShaftJoint> ShaftJointsOf(const mjModel& model, const MotorInModel& motor) {
  std::vector<ShaftJoint> joints;
  const auto add = [&](int joint, double ratio) {
    const std::string name = JointNameAt(model, model.jnt_qposadr[joint]);
    if (model.jnt_type[joint] != mjJNT_HINGE) {
      throw UserError(fmt::format("joint '{}' of the model must be a hinge: motor '{}' turns it",
                                  name, motor.name));
    }
    if (ratio == 0.0) return;
    joints.push_back({.name = name,
                      .dof = model.jnt_dofadr[joint],
                      .qpos = model.jnt_qposadr[joint],
                      .ratio = ratio});
  };
  if (motor.joint >= 0) add(motor.joint, 1.0);
  if (motor.tendon >= 0 && !motor.pulls_cable) {
    const int first = model.tendon_adr[motor.tendon];
    for (int i = first; i < first + model.tendon_num[motor.tendon]; ++i) {
      add(model.wrap_objid[i], model.wrap_prm[i]);
    }
  }
  return joints;
}

/// Rotor of a motor by the armature and the friction of its joints.
void ReadRotor(const mjModel& model, MotorInModel& motor) {
  const std::vector<ShaftJoint> joints = ShaftJointsOf(model, motor);
  for (const ShaftJoint& joint : joints) {
    motor.rotor_inertia_kg_m2 += model.dof_armature[joint.dof] /
                                 (joint.ratio * joint.ratio * static_cast<double>(joints.size()));
  }
  if (joints.size() == 1) {
    motor.dry_friction_nm = model.dof_frictionloss[joints[0].dof] / std::abs(joints[0].ratio);
  }
}

double StallTorque(const HandConfig& config, std::size_t motor, const MotorInModel& in_model,
                   double lever) {
  const double torque =
      OfMotorOr(config.motor.stall_torque_nm, motor, lever * in_model.stall_torque_nm);
  if (torque > 0.0) return torque;
  throw UserError({.key = "hand.motor.stall_torque_nm",
                   .problem = fmt::format(
                       "is needed: the model has no stall torque of motor '{}' (ctrlrange of "
                       "a <motor>, or forcerange)",
                       in_model.name)});
}

/// Radius of the drum that the model does not have.
double DrumRadius(const HandConfig& config, std::size_t motor, const MotorInModel& in_model) {
  const double radius_mm = OfMotorOr(config.motor.drum_radius_mm, motor, 0.0);
  if (radius_mm > 0.0) return 1e-3 * radius_mm;
  throw UserError({.key = "hand.motor.drum_radius_mm",
                   .problem = fmt::format("is needed: motor '{}' pulls a tendon, and the model has "
                                          "no drum for it",
                                          in_model.name)});
}

/// The motor on the spool NAME_spool.
void FindSpool(const mjModel& model, Drive& drive) {
  const int spool = FindInModel(model, mjOBJ_JOINT, drive.name + "_spool");
  drive.spool_qpos = model.jnt_qposadr[spool];
  drive.spool_dof = model.jnt_dofadr[spool];
  const std::string drum_name = drive.name + "_drum";
  const int drum = FindInModel(model, mjOBJ_GEOM, drum_name);
  drive.drum_radius_m = Positive(model.geom_size[3 * drum], "radius of geom", drum_name);
}

/// Length of the cable that a control of 1 winds, if it is an angle; else 0.
double WoundPerControl(const mjModel& model, int actuator) {
  const double gain = model.actuator_gainprm[actuator * mjNGAIN];
  const double stiffness = -model.actuator_biasprm[actuator * mjNBIAS + 1];
  if (model.actuator_gaintype[actuator] != mjGAIN_FIXED ||
      model.actuator_biastype[actuator] != mjBIAS_AFFINE || !(stiffness > 0.0)) {
    return 0.0;
  }
  constexpr double kLargestDrum_m = 0.5;
  const double wound_m = std::abs(gain) / stiffness;
  return wound_m < kLargestDrum_m ? wound_m : 0.0;
}

}  // namespace

double OfMotor(const std::vector<double>& values, std::size_t motor) noexcept {
  return values[values.size() == 1 ? 0 : motor];
}

Leading LeadingOf(int qpos, const std::vector<Follower>& followers) {
  const auto found = std::ranges::find(followers, qpos, &Follower::qpos);
  if (found == followers.end()) return {qpos, 1.0};
  return {found->leader_qpos, found->Slope(found->leader_zero_rad)};
}

int FindInModel(const mjModel& model, int type, const std::string& name) {
  const int index = mj_name2id(&model, type, name.c_str());
  if (index >= 0) return index;
  throw UserError(fmt::format("the model has no {} '{}'{}", KindName(type), name,
                              Suggestion(name, NamesInModel(model, type))));
}

Transmission TransmissionOf(const Drive& drive) {
  if (!drive.has_shaft()) return Transmission::kCables;
  return drive.shaft.joints.size() == 1 && drive.shaft.joints[0].ratio == 1.0
             ? Transmission::kDirect
             : Transmission::kLinkage;
}

std::vector<MotorInModel> MotorsInModel(const mjModel& model) {
  std::vector<MotorInModel> motors;
  for (int actuator = 0; actuator < ActuatorCount(model); ++actuator) {
    const char* name = mj_id2name(&model, mjOBJ_ACTUATOR, actuator);
    if (name == nullptr) {
      throw UserError(fmt::format("motor {} of the model has no name", actuator + 1));
    }
    MotorInModel motor{.name = name};
    motor.has_spool = HasPart(model, mjOBJ_JOINT, motor.name + "_spool") ||
                      HasPart(model, mjOBJ_GEOM, motor.name + "_drum") ||
                      HasPart(model, mjOBJ_TENDON, motor.name + "_flexor") ||
                      HasPart(model, mjOBJ_TENDON, motor.name + "_extensor");
    const int target = model.actuator_trnid[2 * actuator];
    const int kind = model.actuator_trntype[actuator];
    motor.stall_torque_nm = StallOf(model, actuator);
    if (motor.has_spool) {
      motor.stall_torque_nm = model.actuator_ctrlrange[2 * actuator + 1];
    } else if (kind == mjTRN_JOINT || kind == mjTRN_JOINTINPARENT) {
      motor.joint = target;
    } else if (kind == mjTRN_TENDON) {
      motor.tendon = target;
      motor.pulls_cable = model.wrap_type[model.tendon_adr[target]] != mjWRAP_JOINT;
      if (motor.pulls_cable) motor.drum_radius_m = WoundPerControl(model, actuator);
    } else {
      throw UserError(
          fmt::format("motor '{}' of the model must act on a joint or on a tendon", motor.name));
    }
    ReadRotor(model, motor);
    motors.push_back(std::move(motor));
  }
  if (motors.empty()) throw UserError("the model has no motor: no element in <actuator>");
  return motors;
}

std::vector<Drive> FindDrives(mjModel& model, const HandConfig& config) {
  std::vector<Drive> drives;
  for (const MotorInModel& motor : MotorsInModel(model)) {
    const std::size_t index = drives.size();
    Drive drive;
    drive.name = motor.name;
    if (motor.has_spool) {
      FindSpool(model, drive);
    } else if (motor.pulls_cable) {
      drive.pulled_tendon = motor.tendon;
      drive.drum_radius_m = DrumRadius(config, index, motor);
    } else {
      drive.shaft.joints = ShaftJointsOf(model, motor);
      if (!drive.has_shaft()) {
        throw UserError(fmt::format("motor '{}' of the model turns no joint", motor.name));
      }
    }
    const double stall_torque_nm =
        motor.has_spool && config.motor.stall_torque_nm.empty()
            ? Positive(motor.stall_torque_nm, "ctrlrange of motor", drive.name)
            : StallTorque(config, index, motor, motor.pulls_cable ? drive.drum_radius_m : 1.0);
    const auto [key, numbers] = config.ServoOf(stall_torque_nm);
    drive.servo_key = key;
    drive.numbers = numbers;
    drive.play_rad = (config.cable.backlash_deg + drive.numbers.play_deg) * kRadPerDeg;
    drive.servo = MakeServo(drive.numbers, stall_torque_nm, config.motor_limits);
    drive.spool = motor.has_spool ? MakeSpool(config, drive.numbers, index, model, drive.spool_dof)
                                  : MakeRotor(config, drive.numbers, index, motor);
    constexpr double kDampingTimeS = 1e-3;
    drive.shaft.stiffness_nm_rad = stall_torque_nm / (config.motor.windup_deg * kRadPerDeg);
    drive.shaft.damping_nm_s_rad = kDampingTimeS * drive.shaft.stiffness_nm_rad;
    drives.push_back(std::move(drive));
  }
  for (const Drive& drive : drives) {
    for (const ShaftJoint& joint : drive.shaft.joints) {
      AddArmature(model, joint.dof, -model.dof_armature[joint.dof]);
      if (drive.shaft.joints.size() == 1) model.dof_frictionloss[joint.dof] = 0.0;
    }
  }
  FirmConstraints(model, drives);
  return drives;
}

void PlaceShafts(const mjModel& model, const std::vector<HandJoint>& joints,
                 const std::vector<Follower>& followers, std::vector<Drive>& drives) {
  std::vector<double> reference_rad;
  for (const HandJoint& joint : joints) reference_rad.push_back(joint.reference_rad());
  const std::vector<double> qpos = PostureOf(model, joints, reference_rad, followers);
  for (Drive& drive : drives) {
    for (ShaftJoint& joint : drive.shaft.joints) {
      const int leading = LeadingOf(joint.qpos, followers).qpos;
      if (std::ranges::find(joints, leading, &HandJoint::qpos) == joints.end()) {
        throw UserError(
            fmt::format("motor '{}' of the model turns a joint that cannot move", drive.name));
      }
      joint.reference_rad = qpos[joint.qpos];
    }
  }
}

const Drive* OwnDrive(const HandJoint& joint, const std::vector<Drive>& drives) {
  const auto found = std::ranges::find_if(drives, [&](const Drive& drive) {
    return drive.name == joint.name ||
           (drive.shaft.joints.size() == 1 && drive.shaft.joints[0].qpos == joint.qpos);
  });
  return found == drives.end() ? nullptr : &*found;
}

bool Cable::Contains(int branch, int other) const {
  while (branch > other) branch = branches[branch].parent;  // it comes before the branch
  return branch == other;
}

void FindCables(const mjModel& model, const HandConfig& config,
                const std::vector<HandJoint>& joints, const std::vector<Follower>& followers,
                std::vector<Drive>& drives) {
  const CablePaths paths(model, joints, followers);
  // The force of pretension stays what it is with another stiffness.
  const double pretension_m = 1e-3 * config.cable.pretension_mm / config.cable.stiffness_scale;
  for (std::size_t motor = 0; motor < drives.size(); ++motor) {
    Drive& drive = drives[motor];
    if (drive.has_shaft()) continue;
    const bool pulled = drive.pulled_tendon >= 0;
    const int flexor =
        pulled ? drive.pulled_tendon : FindInModel(model, mjOBJ_TENDON, drive.name + "_flexor");
    drive.cables.push_back(MakeCable(model, config.cable, flexor, 1.0, pulled));
    const int extensor = mj_name2id(&model, mjOBJ_TENDON, (drive.name + "_extensor").c_str());
    if (!pulled && extensor >= 0) {
      drive.cables.push_back(MakeCable(model, config.cable, extensor, -1.0, false));
    }
    for (Cable& cable : drive.cables) {
      paths.Trace(cable);
      cable.pretension_n = cable.cord.stiffness_n_m * pretension_m;
      cable.natural_length_m += 1e-3 * OfMotor(config.cable.slack_mm, motor) - pretension_m;
    }
  }
}

}  // namespace gauntlet::sim
