#include "sim/hand/hand_model.h"

#include <fmt/core.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "sim/base/data_folder.h"
#include "sim/base/error.h"
#include "sim/base/hash.h"
#include "sim/base/signal.h"
#include "sim/base/text.h"
#include "sim/hand/assembly_error.h"
#include "sim/hand/cable_geometry.h"
#include "sim/hand/model_files.h"
#include "sim/hand/mujoco_messages.h"
#include "sim/hand/mujoco_versions.h"
#include "sim/hand/stability.h"

namespace gauntlet::sim {
namespace {

using controller::TendonTransmission;

std::filesystem::path ModelPath(const HandConfig& config) {
  if (!config.model_path.empty()) return config.model_path;
  return DataFolder("models") /
         (config.contact == Contact::kObject ? "hand_arm_object.xml" : "hand_arm.xml");
}

/// Does something with the model; what it finds wrong there is said with the model's file.
template <class Action>
auto InModelFile(const std::filesystem::path& path, const Action& action) {
  try {
    return action();
  } catch (const UserError& error) {
    if (!error.key().empty()) throw;  // a setting is wrong, not the model
    throw UserError({.place = path.string(), .problem = error.what()});
  }
}

std::vector<int> SpoolPositions(const std::vector<Drive>& drives) {
  std::vector<int> qpos;
  for (const Drive& drive : drives) {
    if (drive.spool_qpos >= 0) qpos.push_back(drive.spool_qpos);
  }
  return qpos;
}

/// Those that some motor moves; first those with a motor of their own.
/// Errors: UserError for one without a name or a range.
std::vector<HandJoint> MovedJoints(const std::vector<HandJoint>& all,
                                   const std::vector<Drive>& drives,
                                   const std::vector<Follower>& followers) {
  const auto moved = [&](const HandJoint& joint) {
    return std::ranges::any_of(drives, [&](const Drive& drive) {
      return std::ranges::any_of(
                 drive.cables,
                 [&](const Cable& cable) {
                   return std::ranges::any_of(cable.crossings, [&](const Crossing& crossing) {
                     return LeadingOf(crossing.qpos, followers).qpos == joint.qpos;
                   });
                 }) ||
             std::ranges::any_of(drive.shaft.joints, [&](const ShaftJoint& turned) {
               return LeadingOf(turned.qpos, followers).qpos == joint.qpos;
             });
    });
  };
  std::vector<HandJoint> joints;
  for (const Drive& drive : drives) {
    const auto own = std::ranges::find_if(
        all, [&](const HandJoint& joint) { return OwnDrive(joint, drives) == &drive; });
    if (own != all.end()) joints.push_back(*own);
  }
  for (const HandJoint& joint : all) {
    if (std::ranges::find(joints, joint.qpos, &HandJoint::qpos) != joints.end()) continue;
    if (moved(joint)) joints.push_back(joint);
  }
  for (const HandJoint& joint : joints) {
    if (joint.name.empty()) throw UserError("a joint of the model that a motor moves has no name");
    if (!joint.limited) {
      throw UserError(fmt::format("joint '{}' of the model has no range", joint.name));
    }
  }
  return joints;
}

/// Adds to d spool / d joint what this cable says when it keeps its length, times `share`.
void AddCoupling(const Cable& cable, double share, double radius_m,
                 const std::vector<HandJoint>& joints, const std::vector<Follower>& followers,
                 std::span<double> row) {
  for (const Crossing& crossing : cable.crossings) {
    const Leading leading = LeadingOf(crossing.qpos, followers);
    for (std::size_t joint = 0; joint < joints.size(); ++joint) {
      if (joints[joint].qpos != leading.qpos) continue;
      row[joint] -= share * cable.sense * crossing.moment_arm_m * leading.slope / radius_m;
    }
  }
}

/// Adds d spool / d joint of a motor without cables.
void AddCoupling(const Shaft& shaft, const std::vector<HandJoint>& joints,
                 const std::vector<Follower>& followers, std::span<double> row) {
  for (const ShaftJoint& turned : shaft.joints) {
    const Leading leading = LeadingOf(turned.qpos, followers);
    for (std::size_t joint = 0; joint < joints.size(); ++joint) {
      if (joints[joint].qpos == leading.qpos) row[joint] += turned.ratio * leading.slope;
    }
  }
}

/// Names of joints, motors and cables become columns of tables and keys of results.
/// Errors: UserError.
void CheckName(std::string_view what, const std::string& name) {
  std::string problem = NameProblem(name);
  if (problem.empty() && name.find_first_of(",\"") != std::string::npos) {
    problem = "has a comma or a quotation mark, which tables have between names";
  }
  if (name == "summary") problem = "has the name of the scores of the whole hand";
  if (problem.empty()) return;
  throw UserError(fmt::format("{} '{}' of the model {}", what, Shown(name), problem));
}

/// Throws if the spool of a motor cannot turn as far as some posture asks for.
void CheckTravel(const TendonTransmission& transmission, std::size_t motor, const Drive& drive) {
  const std::size_t joints = transmission.joint_names.size();
  double needed_rad = 0.0;
  for (std::size_t joint = 0; joint < joints; ++joint) {
    needed_rad += std::abs(transmission.coupling[motor * joints + joint]) *
                  (transmission.joint_max_rad[joint] - transmission.joint_min_rad[joint]);
  }
  const double needed_deg = needed_rad * kDegPerRad;
  const double travel_deg = drive.numbers.travel_deg;
  if (needed_deg <= travel_deg) return;
  throw UserError(
      {.key = fmt::format("{}.travel_deg", drive.servo_key),
       .problem = fmt::format("{} is too little for the spool of {}, which must wind {:.1f} deg",
                              travel_deg, drive.name, needed_deg)});
}

/// Throws if a motor of the model, whatever its scale, could not hold one of its cables at rest.
void CheckPretension(const Drive& drive, const CableConfig& config) {
  const double stall_n =
      drive.servo.stall_torque_nm / drive.numbers.torque_scale / drive.drum_radius_m;
  for (const Cable& cable : drive.cables) {
    if (cable.pretension_n <= stall_n) continue;
    throw UserError(
        {.key = "hand.cable.pretension_mm",
         .problem = fmt::format(
             "is {}, must be at most {:.2f} here: the cable {} would pull with "
             "{:.0f} N, its motor with {:.0f} N at stall",
             config.pretension_mm,
             std::floor(100.0 * config.pretension_mm * stall_n / cable.pretension_n) / 100.0,
             cable.name, cable.pretension_n, stall_n)});
  }
}

/// Errors: UserError if a setting has neither one value for all motors nor one for each.
void CheckLists(const HandConfig& config, std::size_t motors) {
  const std::pair<const char*, const std::vector<double>&> lists[] = {
      {"hand.motor_friction_scale", config.motor_friction_scale},
      {"hand.cable.slack_mm", config.cable.slack_mm}};
  const std::pair<const char*, const std::vector<double>&> of_motors[] = {
      {"hand.motor.stall_torque_nm", config.motor.stall_torque_nm},
      {"hand.motor.rotor_inertia_kg_m2", config.motor.rotor_inertia_kg_m2},
      {"hand.motor.dry_friction_nm", config.motor.dry_friction_nm},
      {"hand.motor.drum_radius_mm", config.motor.drum_radius_mm}};
  const auto check = [motors](const char* key, const std::vector<double>& values) {
    if (values.size() == 1 || values.size() == motors) return;
    throw UserError({.key = key,
                     .problem = fmt::format("has {} values, must have 1 for all motors or {}, one "
                                            "for each",
                                            values.size(), motors)});
  };
  for (const auto& [key, values] : lists) check(key, values);
  for (const auto& [key, values] : of_motors) {
    if (!values.empty()) check(key, values);
  }
}

/// Errors: UserError for slack of cables where there is none, which would change nothing.
void CheckThereAreCables(const HandConfig& config, const std::vector<Drive>& drives) {
  if (!std::ranges::all_of(drives, &Drive::has_shaft)) return;
  if (std::ranges::all_of(config.cable.slack_mm, [](double value) { return value == 0.0; })) return;
  throw UserError({.key = "hand.cable.slack_mm", .problem = "must be 0: the hand has no cables"});
}

/// Errors: UserError for a limit that the servo cannot have.
void CheckCurrentLimit(const ServoNumbers& numbers, std::string_view servo_key) {
  if (numbers.current_limit_ma <= numbers.stall_current_ma) return;
  throw UserError(
      {.key = fmt::format("{}.current_limit_ma", servo_key),
       .problem =
           numbers.stall_current_ma > 0.0
               ? fmt::format("is {}, must be at most stall_current_ma, {}",
                             numbers.current_limit_ma, numbers.stall_current_ma)
               : fmt::format("is {}, but stall_current_ma of this servo is not known: give it",
                             numbers.current_limit_ma)});
}

void ScaleFriction(const std::vector<double>& scale, std::vector<Drive>& drives) {
  for (std::size_t motor = 0; motor < drives.size(); ++motor) {
    const double factor = OfMotor(scale, motor);
    Drive& drive = drives[motor];
    drive.spool.dry_friction_nm *= factor;
    drive.spool.load_friction *= factor;
    for (Cable& cable : drive.cables) cable.cord.friction_coefficient *= factor;
  }
}

void AddJoints(const std::vector<HandJoint>& joints, const std::vector<Drive>& drives,
               TendonTransmission& transmission) {
  for (const HandJoint& joint : joints) {
    const Drive* const own = OwnDrive(joint, drives);
    transmission.joint_names.push_back(joint.name);
    transmission.motor_of_joint.push_back(own == nullptr ? "" : own->name);
    transmission.reference_angle_rad.push_back(joint.reference_rad());
    transmission.joint_min_rad.push_back(joint.min_rad);
    transmission.joint_max_rad.push_back(joint.max_rad);
  }
}

TendonTransmission MakeTransmission(const HandConfig& config, const std::vector<HandJoint>& joints,
                                    const std::vector<Follower>& followers,
                                    const std::vector<Drive>& drives) {
  TendonTransmission transmission;
  AddJoints(joints, drives, transmission);
  transmission.joint_sensors = config.joint_sensors.kind != JointSensorsKind::kNone;
  for (const Drive& drive : drives) {
    const int counts = 1 << drive.numbers.resolution_bits;
    transmission.counts_per_rad.push_back((counts - 1) / (drive.numbers.travel_deg * kRadPerDeg));
    transmission.center_counts.push_back(counts / 2);
    transmission.min_counts.push_back(0);
    transmission.max_counts.push_back(counts - 1);
  }
  transmission.coupling.assign(drives.size() * joints.size(), 0.0);
  for (std::size_t motor = 0; motor < drives.size(); ++motor) {
    const Drive& drive = drives[motor];
    transmission.motor_names.push_back(drive.name);
    const auto row = std::span(transmission.coupling).subspan(motor * joints.size(), joints.size());
    for (const Cable& cable : drive.cables) {
      AddCoupling(cable, 1.0 / static_cast<double>(drive.cables.size()), drive.drum_radius_m,
                  joints, followers, row);
    }
    AddCoupling(drive.shaft, joints, followers, row);
    const bool moves = std::ranges::any_of(row, [](double turn) { return std::abs(turn) > 1e-3; });
    const auto own = std::ranges::find(joints, drive.name, &HandJoint::name);
    if (!moves || (own != joints.end() && !(std::abs(row[own - joints.begin()]) > 1e-3))) {
      throw UserError(
          fmt::format("the motor '{}' of the model does not move its joint", drive.name));
    }
  }
  return transmission;
}

/// Constants that the engine computes at the model's zero posture, after a change of inertia.
void UpdateConstants(mjModel& model) {
  const std::unique_ptr<mjData, void (*)(mjData*)> data(mj_makeData(&model), &mj_deleteData);
  if (data == nullptr) throw RunError("not enough memory for the hand's model");
  mj_setConst(&model, data.get());
}

void NumberAsIn(const PhysicsModel& physics, Cable& cable) {
  for (Crossing& crossing : cable.crossings) {
    crossing.dof = physics.DofOf(crossing.dof);
    crossing.qpos = physics.QposOf(crossing.qpos);
  }
  for (CableSpan& span : cable.spans) {
    span.dof = physics.DofOf(span.dof);
    span.qpos = physics.QposOf(span.qpos);
  }
}

GraspParts NumberedAsIn(const PhysicsModel& physics, GraspParts grasp) {
  grasp.object_body = physics.BodyOf(grasp.object_body);
  grasp.palm_body = physics.BodyOf(grasp.palm_body);
  grasp.skin_geom = physics.GeomOf(grasp.skin_geom);
  grasp.foot_geom = physics.GeomOf(grasp.foot_geom);
  grasp.qpos = physics.QposOf(grasp.qpos);
  return grasp;
}

/// `palm`: body of the model; below 0: none.
std::vector<JointGroup> GroupsOf(const mjModel& model, int palm,
                                 const std::vector<HandJoint>& joints,
                                 const std::vector<Drive>& drives,
                                 const controller::TendonTransmission& transmission) {
  constexpr auto kArmKey = "hand.arm_servo";
  std::vector<JointGroup> groups(joints.size(), JointGroup::kFinger);
  for (std::size_t joint = 0; joint < joints.size(); ++joint) {
    int body = palm;
    while (body > 0 && body != model.jnt_bodyid[joints[joint].joint]) {
      body = model.body_parentid[body];
    }
    if (body <= 0) continue;
    groups[joint] = JointGroup::kWrist;
    for (std::size_t motor = 0; motor < drives.size(); ++motor) {
      const bool moves = transmission.coupling[motor * joints.size() + joint] != 0.0;
      if (moves && drives[motor].servo_key == kArmKey) groups[joint] = JointGroup::kArm;
    }
  }
  return groups;
}

}  // namespace

std::vector<MotorInModel> ReadMotors(const std::filesystem::path& path) {
  RedirectMujocoMessages();
  TryModel(path, "");
  ReadableMjcf readable;
  const std::unique_ptr<mjModel, void (*)(mjModel*)> model(LoadModel(path, readable),
                                                           &mj_deleteModel);
  return InModelFile(path, [&] { return MotorsInModel(*model); });
}

HandModel::HandModel(const HandConfig& config)
    : HandModel(config, MakeLoopTiming({.longest_step_ms = config.step_ms})) {}

HandModel::HandModel(const HandConfig& config, const LoopTiming& timing)
    : config_(config), file_(ModelPath(config)), timing_(timing), model_(nullptr, &mj_deleteModel) {
  RedirectMujocoMessages();
  controller::CheckSettings(config);
  if (!config.model_path.empty()) TryModel(file_, "hand.model_path");
  ReadableMjcf readable;
  model_.reset(LoadModel(file_, readable));
  notes_ = readable.notes;
  if (const std::string engine = EngineNote(); !engine.empty()) {
    notes_.insert(notes_.begin(), engine);
  }
  model_->opt.timestep = timing.step_s();

  if (config.contact == Contact::kNone) {
    model_->opt.disableflags |= mjDSBL_CONTACT;
  } else if (readable.lacks_contact_shapes) {
    throw UserError({.key = "hand.contact", .problem = "must be none: " + notes_.back()});
  } else {
    model_->opt.disableflags &= ~mjDSBL_CONTACT;
  }
  CheckCurrentLimit(config.servo.numbers(), "hand.servo");
  CheckCurrentLimit(config.arm_servo.numbers(), "hand.arm_servo");
  InModelFile(file_, [&] {
    if (config.contact == Contact::kObject) grasp_ = MakeObject(*model_, config.object);
    followers_ = FindFollowers(*model_);
  });
  const int motors = ActuatorCount(*model_);
  if (motors > 0) CheckLists(config, static_cast<std::size_t>(motors));
  InModelFile(file_, [&] { drives_ = FindDrives(*model_, config); });
  CheckThereAreCables(config, drives_);
  InModelFile(file_, [&] {
    const auto all = FindJoints(*model_, followers_, SpoolPositions(drives_));
    PlaceShafts(*model_, all, followers_, drives_);
    FindCables(*model_, config, all, followers_, drives_);
    engine_measures_cables_ = !FindCableSpans(*model_, all, followers_, drives_);
    joints_ = MovedJoints(all, drives_, followers_);
    for (const HandJoint& joint : joints_) CheckName("joint", joint.name);
    for (const Drive& drive : drives_) {
      CheckName("motor", drive.name);
      for (const Cable& cable : drive.cables) CheckName("cable", cable.name);
    }
  });
  transmission_ =
      InModelFile(file_, [&] { return MakeTransmission(config, joints_, followers_, drives_); });
  center_error_rad_ = AssembleWithErrors(config.assembly_error, joints_, followers_, drives_);
  as_built_ = MakeTransmission(config, joints_, followers_, drives_);
  ScaleFriction(config.motor_friction_scale, drives_);
  if (std::ranges::any_of(drives_, &Drive::has_shaft)) UpdateConstants(*model_);
  CheckStability(*model_, drives_);
  GiveLightJointsInertia(*model_, drives_);
  for (std::size_t motor = 0; motor < drives_.size(); ++motor) {
    CheckTravel(transmission_, motor, drives_[motor]);
    CheckPretension(drives_[motor], config.cable);
    for (const Cable& cable : drives_[motor].cables) {
      cable_names_.push_back(cable.name);
      // CableTension() takes over: a spring of the engine would push when slack. A tendon that a
      // motor pulls keeps its own.
      if (drives_[motor].pulled_tendon >= 0) continue;
      model_->tendon_stiffness[cable.tendon] = 0.0;
      model_->tendon_damping[cable.tendon] = 0.0;
    }
  }
  InModelFile(file_, [&] { physics_.emplace(*model_, drives_, engine_measures_cables_); });
  for (Drive& drive : drives_) {
    for (Cable& cable : drive.cables) NumberAsIn(*physics_, cable);
    for (ShaftJoint& joint : drive.shaft.joints) {
      joint.dof = physics_->DofOf(joint.dof);
      joint.qpos = physics_->QposOf(joint.qpos);
    }
  }
  if (grasp_.exists()) grasp_in_physics_ = NumberedAsIn(*physics_, grasp_);
  std::vector<int> bodies(model_->nbody);
  for (int body = 0; body < model_->nbody; ++body) bodies[body] = physics_->BodyOf(body);
  const int palm = mj_name2id(model_.get(), mjOBJ_BODY, "palm");
  digits_ = Digits(*model_, palm, bodies);
  joint_groups_ = GroupsOf(*model_, palm, joints_, drives_, transmission_);
  if (palm >= 0 && model_->body_weldid[palm] != 0) moving_palm_ = bodies[palm];
}

std::string HandModel::NameOfJointAt(int qpos) const { return JointNameAt(*model_, qpos); }

std::vector<std::string> HandModel::CameraNames() const {
  std::vector<std::string> names;
  for (int i = 0; i < model_->ncam; ++i) {
    if (const char* name = mj_id2name(model_.get(), mjOBJ_CAMERA, i)) names.emplace_back(name);
  }
  return names;
}

std::string HandModel::EngineVersion() { return mj_versionString(); }

std::string HandModel::OtherEngine() {
  return mj_version() == mjVERSION_HEADER ? "" : mj_versionString();
}

std::string HandModel::EngineNote() {
  if (kIsReference) return {};
  return fmt::format(
      "The physics engine is MuJoCo {}; results of Gauntlet's own pages are of 2.2.2.",
      EngineVersion());
}

std::string HandModel::Hash() const {
  std::string bytes(static_cast<std::size_t>(mj_sizeModel(model_.get())), '\0');
  mj_saveModel(model_.get(), nullptr, bytes.data(), static_cast<int>(bytes.size()));
  sim::Hash hash;
  hash.Add(bytes);
  hash.Add(std::span<const double>(as_built_.coupling));
  for (const Drive& drive : drives_) {
    const ServoNumbers& servo = drive.numbers;
    const double numbers[] = {drive.drum_radius_m,
                              drive.play_rad,
                              drive.servo.gain_nm_rad,
                              drive.servo.damping_nm_s_rad,
                              drive.servo.dead_band_rad,
                              drive.servo.stall_torque_nm,
                              drive.servo.no_load_speed_rad_s,
                              drive.servo.current_share,
                              drive.servo.limits_supply ? 1.0 : 0.0,
                              drive.spool.inertia_kg_m2,
                              drive.spool.damping_nm_s_rad,
                              drive.spool.dry_friction_nm,
                              drive.spool.load_friction,
                              servo.frame_ms,
                              servo.free_running ? 1.0 : 0.0,
                              servo.dead_time_ms,
                              static_cast<double>(servo.sensor_bits),
                              servo.sensor_noise_deg};
    hash.Add(std::span<const double>(numbers));
    for (const Cable& cable : drive.cables) {
      const double of_cable[] = {cable.cord.stiffness_n_m, cable.cord.damping_n_s_m,
                                 cable.cord.friction_coefficient, cable.natural_length_m};
      hash.Add(std::span<const double>(of_cable));
    }
    for (const ShaftJoint& joint : drive.shaft.joints) {
      const double of_shaft[] = {joint.ratio, drive.shaft.stiffness_nm_rad,
                                 drive.shaft.damping_nm_s_rad, drive.shaft.zero_error_rad};
      hash.Add(std::span<const double>(of_shaft));
    }
  }
  return hash.Text();
}

}  // namespace gauntlet::sim
