#include <fmt/core.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>

#include "sim/base/error.h"
#include "sim/base/hash.h"
#include "sim/base/signal.h"
#include "sim/hand/hand.h"
#include "sim/hand/mujoco_messages.h"
#include "sim/hand/stability.h"

namespace gauntlet::sim {
namespace {

using controller::TendonTransmission;

std::filesystem::path ModelPath(const HandConfig& config) {
  if (!config.model_path.empty()) return config.model_path;
  const char* folder = std::getenv("GAUNTLET_MODELS");
  return std::filesystem::path(folder != nullptr && *folder ? folder : GAUNTLET_MODEL_DIR) /
         (config.contact == Contact::kObject ? "hand_arm_object.xml" : "hand_arm.xml");
}

mjModel* LoadModel(const std::filesystem::path& path) {
  if (!std::filesystem::exists(path)) {
    throw UserError({.key = "hand.model_path", .problem = "no file " + path.string()});
  }
  char message[1000] = "";
  mjModel* model = nullptr;
  try {
    model = mj_loadXML(path.c_str(), nullptr, message, sizeof message);
  } catch (const RunError& error) {
    throw UserError({.place = path.string(), .problem = error.what()});
  }
  TakeMujocoWarning();
  if (model != nullptr) return model;
  std::string line = message;
  for (char& letter : line) letter = letter == '\n' ? ' ' : letter;
  throw UserError({.place = path.string(), .problem = line});
}

/// Does something with the model; what it finds wrong there is said with the model's file.
template <class Action>
auto InModelFile(const std::filesystem::path& path, const Action& action) {
  try {
    return action();
  } catch (const UserError& error) {
    throw UserError({.place = path.string(), .problem = error.what()});
  }
}

/// How many physics steps make one sample of 1 ms.
int StepsPerSample(double step_ms) {
  const double steps = std::round(1.0 / step_ms);
  if (std::abs(steps * step_ms - 1.0) < 1e-9) return static_cast<int>(steps);
  throw UserError(fmt::format(
      "hand.step_ms: {} does not divide 1 ms (allowed: 1, 0.5, 0.25, 0.2, 0.125, 0.1, ...)",
      step_ms));
}

std::vector<int> ChannelJoints(const mjModel& model, const std::vector<std::string>& names) {
  std::vector<int> joints;
  for (const std::string& name : names) {
    const int joint = FindInModel(model, mjOBJ_JOINT, name);
    if (!model.jnt_limited[joint]) {
      throw UserError(fmt::format("joint '{}' of the model has no range", name));
    }
    joints.push_back(joint);
  }
  return joints;
}

/// d spool / d channel when the cable keeps its length; `sense` is 1 for a flexor.
void AddCoupling(const Cable& cable, double sense, double radius_m, bool interference,
                 const std::vector<int>& channel_qpos, const std::vector<Follower>& followers,
                 std::span<double> row) {
  for (const Crossing& crossing : cable.crossings) {
    if (!interference && !crossing.own) continue;
    int qpos = crossing.qpos;
    double slope = 1.0;
    for (const Follower& follower : followers) {
      if (follower.qpos != crossing.qpos) continue;
      qpos = follower.leader_qpos;
      slope = follower.Slope(follower.leader_zero_rad);
    }
    for (std::size_t channel = 0; channel < channel_qpos.size(); ++channel) {
      if (channel_qpos[channel] != qpos) continue;
      row[channel] -= 0.5 * sense * crossing.moment_arm_m * slope / radius_m;
    }
  }
}

/// Throws if the spool of a motor cannot turn as far as some posture asks for.
void CheckTravel(const TendonTransmission& transmission, std::size_t motor, double travel_deg) {
  const std::size_t channels = transmission.channel_names.size();
  double needed_rad = 0.0;
  for (std::size_t channel = 0; channel < channels; ++channel) {
    needed_rad += std::abs(transmission.coupling[motor * channels + channel]) *
                  (transmission.joint_max_rad[channel] - transmission.joint_min_rad[channel]);
  }
  const double needed_deg = needed_rad * kDegPerRad;
  if (needed_deg <= travel_deg) return;
  throw UserError(fmt::format(
      "hand.servo.travel_deg: {} is too little for the spool of {}, which must wind {:.1f} deg",
      travel_deg, transmission.motor_names[motor], needed_deg));
}

TendonTransmission MakeTransmission(const mjModel& model, const HandConfig& config,
                                    const std::vector<std::string>& names,
                                    const std::vector<int>& joints,
                                    const std::vector<double>& reference_rad,
                                    const std::vector<Follower>& followers,
                                    const std::vector<Drive>& drives) {
  TendonTransmission transmission;
  transmission.channel_names = names;
  transmission.motor_names = names;
  const std::size_t count = names.size();
  transmission.reference_angle_rad = reference_rad;
  std::vector<int> channel_qpos;
  for (int joint : joints) {
    transmission.joint_min_rad.push_back(model.jnt_range[2 * joint]);
    transmission.joint_max_rad.push_back(model.jnt_range[2 * joint + 1]);
    channel_qpos.push_back(model.jnt_qposadr[joint]);
  }
  const int counts = 1 << config.servo.resolution_bits;
  transmission.counts_per_rad.assign(count, (counts - 1) / (config.servo.travel_deg * kRadPerDeg));
  transmission.center_counts.assign(count, counts / 2);
  transmission.min_counts.assign(count, 0);
  transmission.max_counts.assign(count, counts - 1);
  transmission.coupling.assign(count * count, 0.0);
  for (std::size_t motor = 0; motor < count; ++motor) {
    const Drive& drive = drives[motor];
    const auto row = std::span(transmission.coupling).subspan(motor * count, count);
    const bool interference = config.cable.interference;
    AddCoupling(drive.flexor, 1.0, drive.drum_radius_m, interference, channel_qpos, followers, row);
    AddCoupling(drive.extensor, -1.0, drive.drum_radius_m, interference, channel_qpos, followers,
                row);
    if (!(std::abs(row[motor]) > 1e-3)) {
      throw UserError(
          fmt::format("the cables of '{}' in the model do not move its joint", names[motor]));
    }
  }
  return transmission;
}

}  // namespace

HandModel::HandModel(const HandConfig& config, const std::vector<std::string>& channel_names)
    : config_(config), model_(nullptr, &mj_deleteModel) {
  TakeOverMujocoMessages();
  controller::CheckSettings(config);
  steps_per_sample_ = StepsPerSample(config.step_ms);
  const std::filesystem::path path = ModelPath(config);
  model_.reset(LoadModel(path));
  model_->opt.timestep = 1e-3 / steps_per_sample_;

  if (config.contact != Contact::kNone) model_->opt.disableflags &= ~mjDSBL_CONTACT;
  if (config.contact == Contact::kObject) {
    grasp_ = InModelFile(path, [&] { return MakeObject(*model_, config.object); });
  }

  const std::vector<int> joints =
      InModelFile(path, [&] { return ChannelJoints(*model_, channel_names); });
  std::vector<double> reference_rad;
  for (int joint : joints) {
    channel_qpos_.push_back(model_->jnt_qposadr[joint]);
    reference_rad.push_back(0.5 *
                            (model_->jnt_range[2 * joint] + model_->jnt_range[2 * joint + 1]));
  }
  followers_ = FindFollowers(*model_);
  drives_ = InModelFile(path, [&] {
    return FindDrives(*model_, config, channel_names, joints, reference_rad, followers_);
  });
  CheckStability(*model_, drives_);
  transmission_ = InModelFile(path, [&] {
    return MakeTransmission(*model_, config, channel_names, joints, reference_rad, followers_,
                            drives_);
  });
  for (std::size_t motor = 0; motor < channel_names.size(); ++motor) {
    CheckTravel(transmission_, motor, config.servo.travel_deg);
  }
  for (const Drive& drive : drives_) {
    for (const Cable* cable : {&drive.flexor, &drive.extensor}) {
      cable_names_.emplace_back(mj_id2name(model_.get(), mjOBJ_TENDON, cable->tendon));
      // CableTension() takes over: a spring of the engine would push when slack.
      model_->tendon_stiffness[cable->tendon] = 0.0;
      model_->tendon_damping[cable->tendon] = 0.0;
    }
  }
}

std::string HandModel::EngineVersion() { return mj_versionString(); }

std::string HandModel::Hash() const {
  std::string bytes(static_cast<std::size_t>(mj_sizeModel(model_.get())), '\0');
  mj_saveModel(model_.get(), nullptr, bytes.data(), static_cast<int>(bytes.size()));
  sim::Hash hash;
  hash.Add(bytes);
  for (const Drive& drive : drives_) {
    const double numbers[] = {drive.drum_radius_m,           drive.servo.gain_nm_rad,
                              drive.servo.damping_nm_s_rad,  drive.servo.dead_band_rad,
                              drive.servo.stall_torque_nm,   drive.servo.no_load_speed_rad_s,
                              drive.flexor.stiffness_n_m,    drive.flexor.damping_n_s_m,
                              drive.flexor.natural_length_m, drive.extensor.stiffness_n_m,
                              drive.extensor.damping_n_s_m,  drive.extensor.natural_length_m};
    hash.Add(std::span<const double>(numbers));
  }
  return hash.Text();
}

}  // namespace gauntlet::sim
