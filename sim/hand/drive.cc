#include "sim/hand/drive.h"

#include <fmt/core.h>
#include <mujoco/mujoco.h>

#include <algorithm>

#include "sim/base/error.h"
#include "sim/base/nearest_name.h"
#include "sim/base/signal.h"
#include "sim/hand/cable_path.h"

namespace gauntlet::sim {
namespace {

/// Stiffness that stands for a cable that does not stretch, as a multiple of the real one. At 1 ms
/// the hand stays stable up to 32 times.
constexpr double kInextensible = 8.0;

/// Names of all parts of one kind.
std::vector<std::string> NamesInModel(const mjModel& model, int type) {
  std::vector<std::string> names;
  for (int index = 0;; ++index) {
    const char* name = mj_id2name(&model, type, index);
    const int count = type == mjOBJ_JOINT      ? model.njnt
                      : type == mjOBJ_TENDON   ? model.ntendon
                      : type == mjOBJ_ACTUATOR ? model.nu
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

Spool MakeSpool(const ServoNumbers& numbers, const mjModel& model, int dof) {
  return {.inertia_kg_m2 = numbers.inertia_scale * model.dof_M0[dof],
          .damping_nm_s_rad = model.dof_damping[dof],
          .dry_friction_nm = numbers.friction_scale * model.dof_frictionloss[dof],
          .load_friction = numbers.load_friction};
}

double Positive(double value, const std::string& what, const std::string& name) {
  if (value > 0.0) return value;
  throw UserError(fmt::format("{} '{}' of the model is {}: must be above 0", what, name, value));
}

/// How many times larger than in the model's file stiffness is.
double StiffnessFactor(const CableConfig& config) {
  return config.stiffness_scale * (config.stretch ? 1.0 : kInextensible);
}

/// Everything about a cable but its path.
Cable MakeCable(const mjModel& model, const CableConfig& config, const std::string& name,
                double sense) {
  Cable cable;
  cable.name = name;
  cable.sense = sense;
  cable.tendon = FindInModel(model, mjOBJ_TENDON, name);
  const double factor = StiffnessFactor(config);
  const double stiffness =
      Positive(model.tendon_stiffness[cable.tendon], "stiffness of tendon", name);
  cable.cord = {.stiffness_n_m = factor * stiffness,
                .damping_n_s_m = model.tendon_damping[cable.tendon],
                .friction_coefficient = config.capstan_friction};
  if (cable.cord.damping_n_s_m < 0.0) {
    throw UserError(fmt::format("damping of tendon '{}' of the model is {}: must not be below 0",
                                name, cable.cord.damping_n_s_m));
  }
  return cable;
}

CableWear MakeWear(const WearConfig& config, std::size_t motor, const std::string& cable) {
  CableWear wear{.longer_m_per_s = 1e-3 * OfMotor(config.slack_mm_per_hour, motor) / 3600.0,
                 .longer_per_travel = 1e-6 * OfMotor(config.slack_mm_per_km, motor)};
  if (config.snap.cable == cable) wear.snaps_at_s = config.snap.at_s;
  return wear;
}

}  // namespace

double OfMotor(const std::vector<double>& values, std::size_t motor) noexcept {
  return values[values.size() == 1 ? 0 : motor];
}

Leading LeadingOf(const Crossing& crossing, const std::vector<Follower>& followers) {
  const auto found = std::ranges::find(followers, crossing.qpos, &Follower::qpos);
  if (found == followers.end()) return {crossing.qpos, 1.0};
  return {found->leader_qpos, found->Slope(found->leader_zero_rad)};
}

int FindInModel(const mjModel& model, int type, const std::string& name) {
  const int index = mj_name2id(&model, type, name.c_str());
  if (index >= 0) return index;
  throw UserError(fmt::format("the model has no {} '{}'{}", KindName(type), name,
                              Suggestion(name, NamesInModel(model, type))));
}

std::vector<Drive> FindDrives(const mjModel& model, const HandConfig& config) {
  std::vector<Drive> drives;
  for (int actuator = 0; actuator < model.nu; ++actuator) {
    const char* name = mj_id2name(&model, mjOBJ_ACTUATOR, actuator);
    if (name == nullptr) {
      throw UserError(fmt::format("motor {} of the model has no name", actuator + 1));
    }
    Drive drive;
    drive.name = name;
    const int spool = FindInModel(model, mjOBJ_JOINT, drive.name + "_spool");
    drive.spool_qpos = model.jnt_qposadr[spool];
    drive.spool_dof = model.jnt_dofadr[spool];
    const std::string drum_name = drive.name + "_drum";
    const int drum = FindInModel(model, mjOBJ_GEOM, drum_name);
    drive.drum_radius_m = Positive(model.geom_size[3 * drum], "radius of geom", drum_name);
    const double stall_torque_nm =
        Positive(model.actuator_ctrlrange[2 * actuator + 1], "ctrlrange of motor", drive.name);
    const auto [key, numbers] = config.ServoOf(stall_torque_nm);
    drive.servo_key = key;
    drive.numbers = numbers;
    drive.play_rad = (config.cable.backlash_deg + drive.numbers.play_deg) * kRadPerDeg;
    drive.servo = MakeServo(drive.numbers, stall_torque_nm, config.motor_limits);
    drive.spool = MakeSpool(drive.numbers, model, drive.spool_dof);
    drives.push_back(std::move(drive));
  }
  if (drives.empty()) throw UserError("the model has no motor");
  return drives;
}

void FindCables(const mjModel& model, const HandConfig& config,
                const std::vector<HandJoint>& joints, const std::vector<Follower>& followers,
                std::vector<Drive>& drives) {
  const CablePaths paths(model, joints, followers);
  // The force of pretension stays what it is with another stiffness.
  const double pretension_m = 1e-3 * config.cable.pretension_mm / StiffnessFactor(config.cable);
  for (std::size_t motor = 0; motor < drives.size(); ++motor) {
    Drive& drive = drives[motor];
    // A joint with a motor of its own name is that motor's alone.
    const auto meant = [&](int dof) {
      const auto joint = std::ranges::find(joints, dof, &HandJoint::dof);
      if (joint == joints.end() || joint->name == drive.name) return true;
      return std::ranges::find(drives, joint->name, &Drive::name) == drives.end();
    };
    drive.cables.push_back(MakeCable(model, config.cable, drive.name + "_flexor", 1.0));
    const std::string extensor = drive.name + "_extensor";
    if (mj_name2id(&model, mjOBJ_TENDON, extensor.c_str()) >= 0) {
      drive.cables.push_back(MakeCable(model, config.cable, extensor, -1.0));
    }
    for (Cable& cable : drive.cables) {
      paths.Trace(cable, meant);
      cable.wear = MakeWear(config.wear, motor, cable.name);
      cable.pretension_n = cable.cord.stiffness_n_m * pretension_m;
      cable.natural_length_m += 1e-3 * OfMotor(config.cable.slack_mm, motor) - pretension_m;
    }
  }
}

}  // namespace gauntlet::sim
