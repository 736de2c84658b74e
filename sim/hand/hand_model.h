#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "controller/controller_config.h"
#include "sim/base/timing.h"
#include "sim/hand/digits.h"
#include "sim/hand/drive.h"
#include "sim/hand/grasp.h"
#include "sim/hand/hand_config.h"
#include "sim/hand/physics_model.h"

namespace gauntlet::sim {

/// The motors of a model of other people, and what the file says of them.
/// Errors: UserError, as of HandModel.
std::vector<MotorInModel> ReadMotors(const std::filesystem::path& model);

/// The hand and arm as one compiled, const model, shared by all threads of a comparison.
///
/// The model declares all that there is: a motor is an actuator NAME on the spool joint NAME_spool
/// with the drum NAME_drum, the cable NAME_flexor and, unless springs pull back, NAME_extensor; or
/// an actuator on a joint, or on a tendon of joints, that it turns without cables; or on a spatial
/// tendon that it pulls. A joint is every other hinge that a motor moves and that does not follow
/// another by a linkage; joints with a motor of their own come first, in the order of motors, then
/// the others in the model's order.
/// Errors: UserError for settings that the model cannot take.
class HandModel {
 public:
  HandModel(const HandConfig& config, const LoopTiming& timing);
  /// At ticks of 1 ms.
  explicit HandModel(const HandConfig& config);
  HandModel(const HandModel&) = delete;
  HandModel& operator=(const HandModel&) = delete;

  /// All that there is; for pictures.
  const mjModel_& model() const { return *model_; }
  /// Model that a Hand steps.
  const PhysicsModel& physics() const { return *physics_; }
  /// Some cable is no sum of functions of one joint angle each: slower.
  bool engine_measures_cables() const { return engine_measures_cables_; }
  const HandConfig& config() const { return config_; }
  /// The file that the model was read from.
  const std::filesystem::path& file() const { return file_; }
  const LoopTiming& timing() const { return timing_; }
  /// Facts of this hand for a controller: joints, motors, coupling, ranges, counts.
  const controller::TendonTransmission& transmission() const { return transmission_; }
  /// The coupling of the hand as it was built; another one where it has errors of assembly.
  const controller::TendonTransmission& as_built() const { return as_built_; }
  /// Per joint: where it stands when the controller takes it to be in the middle of its range, less
  /// that middle [rad].
  const std::vector<double>& center_error_rad() const { return center_error_rad_; }
  const std::vector<std::string>& joint_names() const { return transmission_.joint_names; }
  const std::vector<std::string>& motor_names() const { return transmission_.motor_names; }
  /// Cables of all motors in their order: first the flexor, then the extensor if there is one.
  const std::vector<std::string>& cable_names() const { return cable_names_; }

  // Positions and degrees of freedom are numbered as in the whole model; those of cables, as in the
  // physics model.
  const std::vector<HandJoint>& joints() const { return joints_; }
  const std::vector<Follower>& followers() const { return followers_; }
  const std::vector<Drive>& drives() const { return drives_; }
  const GraspParts& grasp() const { return grasp_; }
  const GraspParts& grasp_in_physics() const { return grasp_in_physics_; }
  const Digits& digits() const { return digits_; }
  const std::vector<JointGroup>& joint_groups() const { return joint_groups_; }
  /// Body of the physics model that carries the digits; -1 where it stands still, or there is none.
  int moving_palm() const { return moving_palm_; }

  /// Parts of the model's file that were left out, a sentence each; see ReadModelText().
  const std::vector<std::string>& notes() const { return notes_; }

  /// Name of the joint with this position in qpos of the whole model; empty for one without a name.
  std::string NameOfJointAt(int qpos) const;

  /// For pictures of the hand, in the model's order.
  std::vector<std::string> CameraNames() const;

  /// Hash of the compiled model and everything that shapes it, for `scenario.resolved.yaml`.
  std::string Hash() const;
  /// Version of MuJoCo, as "2.2.2".
  static std::string EngineVersion();
  /// The version of the MuJoCo that this process calls, if this was not compiled for it; else
  /// empty.
  static std::string OtherEngine();
  /// A sentence for answers if that is not the reference (mujoco_versions.h); else empty.
  static std::string EngineNote();

 private:
  HandConfig config_;
  std::filesystem::path file_;
  LoopTiming timing_;
  std::vector<std::string> notes_;
  std::unique_ptr<mjModel_, void (*)(mjModel_*)> model_;
  std::optional<PhysicsModel> physics_;
  bool engine_measures_cables_ = false;
  std::vector<HandJoint> joints_;
  std::vector<Follower> followers_;
  std::vector<Drive> drives_;
  GraspParts grasp_;
  GraspParts grasp_in_physics_;
  Digits digits_;
  std::vector<JointGroup> joint_groups_;
  int moving_palm_ = -1;
  std::vector<std::string> cable_names_;
  controller::TendonTransmission transmission_;
  controller::TendonTransmission as_built_;
  std::vector<double> center_error_rad_;
};

}  // namespace gauntlet::sim
