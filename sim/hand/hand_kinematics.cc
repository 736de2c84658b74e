#include "sim/hand/hand_kinematics.h"

#include <fmt/core.h>
#include <mujoco/mujoco.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include "controller/assert.h"
#include "sim/base/error.h"
#include "sim/hand/hand_model.h"
#include "sim/hand/model_files.h"
#include "sim/hand/mujoco_messages.h"

namespace gauntlet::sim {
namespace {

using Eigen::Vector3d;
using RowMatrix3 = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;

Eigen::Map<const Vector3d> PlaceAt(const double* numbers, int index) {
  return Eigen::Map<const Vector3d>(numbers + 3 * index);
}

std::string NameIn(const mjModel& model, mjtObj kind, int index) {
  const char* name = mj_id2name(&model, kind, index);
  return name == nullptr ? "" : name;
}

bool IsTipName(std::string name) {
  std::ranges::transform(name, name.begin(), [](char c) { return std::tolower(c); });
  return name.find("tip") != std::string::npos;
}

bool IsInside(const mjModel& model, int body, int outer) {
  while (body > outer) body = model.body_parentid[body];
  return body == outer;
}

/// True for a joint that carries a spool: by its name, see HandModel.
bool IsSpool(const std::string& name) { return name.ends_with("_spool"); }

}  // namespace

HandKinematics::HandKinematics(const std::filesystem::path& model, const std::string& key,
                               const FingerOfName& finger_of)
    : file_(model.string()), model_(nullptr, &mj_deleteModel), data_(nullptr, &mj_deleteData) {
  RedirectMujocoMessages();
  TryModel(model, key);
  ReadableMjcf readable;
  model_.reset(LoadModel(model, readable));
  notes_ = readable.notes;
  FindParts(finger_of);
}

HandKinematics::HandKinematics(const HandModel& hand, const FingerOfName& finger_of)
    : file_("the model of the hand"),
      model_(mj_copyModel(nullptr, &hand.model()), &mj_deleteModel),
      data_(nullptr, &mj_deleteData) {
  FindParts(finger_of);
}

void HandKinematics::FindParts(const FingerOfName& finger_of) {
  data_.reset(mj_makeData(model_.get()));
  if (data_ == nullptr) throw RunError("not enough memory for the hand's model");
  followers_ = FindFollowers(*model_);
  FindDigits(finger_of);
  FindJoints();
  std::vector<int> bodies(model_->nbody);
  std::iota(bodies.begin(), bodies.end(), 0);
  capsules_ = Digits(*model_, palm_, bodies);
  FindFrame();
}

HandKinematics::~HandKinematics() = default;

void HandKinematics::Fail(const std::string& problem) const {
  throw UserError({.place = file_, .problem = problem});
}

void HandKinematics::FindDigits(const FingerOfName& finger_of) {
  for (int joint = 0; joint < model_->njnt; ++joint) {
    const std::string name = NameIn(*model_, mjOBJ_JOINT, joint);
    if (model_->jnt_type[joint] != mjJNT_HINGE || IsSpool(name)) continue;
    const auto found = std::ranges::find(kFingerNames, finger_of(name));
    if (found == kFingerNames.end()) continue;
    Digit& digit = digits_[found - kFingerNames.begin()];
    const int body = model_->jnt_bodyid[joint];
    if (digit.exists && !IsInside(*model_, body, digit.tip_body)) continue;
    digit.exists = true;
    digit.tip_body = body;
  }
  const auto fingers = std::ranges::count_if(digits_, &Digit::exists);
  if (!digits_[kThumb].exists || fingers < 3) {
    Fail(
        "must have joints of a thumb and of two fingers or more, with names as thumb_mcp, FFJ3, "
        "if_mcp");
  }
  palm_ = digits_[kThumb].tip_body;
  for (const Digit& digit : digits_) {
    while (digit.exists && !IsInside(*model_, digit.tip_body, palm_)) {
      palm_ = model_->body_parentid[palm_];
    }
  }
  for (Digit& digit : digits_) {
    if (!digit.exists) continue;
    for (int body = digit.tip_body; body != palm_; body = model_->body_parentid[body]) {
      for (int i = model_->body_jntnum[body] - 1; i >= 0; --i) {
        const int joint = model_->body_jntadr[body] + i;
        if (model_->jnt_type[joint] == mjJNT_HINGE) digit.hinges.push_back(joint);
      }
    }
    if (digit.hinges.empty()) Fail("two digits have the same joints");
    FindTip(digit);
  }
}

void HandKinematics::FindTip(Digit& digit) const {
  const int last_hinge = digit.hinges.front();
  const Vector3d joint = PlaceAt(model_->jnt_pos, last_hinge);
  mj_kinematics(model_.get(), data_.get());
  const auto in_tip_body = [&](const double* world_m) {
    return Vector3d(Eigen::Map<const RowMatrix3>(data_->xmat + 9 * digit.tip_body).transpose() *
                    (Eigen::Map<const Vector3d>(world_m) - PlaceAt(data_->xpos, digit.tip_body)));
  };
  int best_rank = 0;
  double farthest_m = 0.0;
  const auto offer = [&](int rank, const Vector3d& place_m, int capsule) {
    const double distance_m = (place_m - joint).norm();
    if (rank < best_rank || (rank == best_rank && distance_m <= farthest_m)) return;
    best_rank = rank;
    farthest_m = distance_m;
    digit.tip_in_body_m = place_m;
    digit.tip_geom = capsule;
    if (capsule >= 0)
      digit.tip_radius_m = model_->geom_size[3 * static_cast<std::ptrdiff_t>(capsule)];
  };
  for (int geom = 0; geom < model_->ngeom; ++geom) {
    if (!IsInside(*model_, model_->geom_bodyid[geom], digit.tip_body)) continue;
    const Vector3d center = in_tip_body(data_->geom_xpos + 3 * geom);
    offer(IsTipName(NameIn(*model_, mjOBJ_GEOM, geom)) ? 2 : 1, center, -1);
    const bool touches = model_->geom_contype[geom] != 0 || model_->geom_conaffinity[geom] != 0;
    if (model_->geom_type[geom] != mjGEOM_CAPSULE || !touches) continue;
    const double* axes = data_->geom_xmat + 9 * geom;
    for (const double side : {-1.0, 1.0}) {
      double end_m[3];
      for (int i = 0; i < 3; ++i) {
        end_m[i] = data_->geom_xpos[3 * geom + i] +
                   side * model_->geom_size[3 * geom + 1] * axes[3 * i + 2];
      }
      offer(3, in_tip_body(end_m), geom);
    }
  }
  for (int site = 0; site < model_->nsite; ++site) {
    if (!IsInside(*model_, model_->site_bodyid[site], digit.tip_body)) continue;
    if (!IsTipName(NameIn(*model_, mjOBJ_SITE, site))) continue;
    offer(2, in_tip_body(data_->site_xpos + 3 * site), -1);
  }
  if (best_rank == 0) {
    Fail(fmt::format("body '{}' has no geom, so the fingertip is unknown",
                     NameIn(*model_, mjOBJ_BODY, digit.tip_body)));
  }
}

void HandKinematics::FindJoints() {
  std::vector<int> spools;
  for (int joint = 0; joint < model_->njnt; ++joint) {
    if (IsSpool(NameIn(*model_, mjOBJ_JOINT, joint))) spools.push_back(model_->jnt_qposadr[joint]);
  }
  const auto hinge_of = [this](int finger, int qpos) {
    return std::ranges::any_of(digits_[finger].hinges,
                               [&](int hinge) { return model_->jnt_qposadr[hinge] == qpos; });
  };
  for (const HandJoint& joint : sim::FindJoints(*model_, followers_, spools)) {
    std::array<bool, kFingers> moves = {};
    for (int finger = 0; finger < kFingers; ++finger) {
      moves[finger] = hinge_of(finger, joint.qpos);
      for (const Follower& follower : followers_) {
        moves[finger] |= follower.leader_qpos == joint.qpos && hinge_of(finger, follower.qpos);
      }
    }
    if (!std::ranges::any_of(moves, std::identity())) {
      if (!joint.name.empty()) other_joint_names_.push_back(joint.name);
      continue;
    }
    if (joint.name.empty()) Fail("a joint that moves a fingertip has no name");
    if (!joint.limited) Fail(fmt::format("joint '{}' has no range", joint.name));
    joints_.push_back(joint);
    moves_.push_back(moves);
  }
}

std::vector<double> HandKinematics::NeutralAngles() const {
  std::vector<double> angles;
  for (const HandJoint& joint : joints_) {
    angles.push_back(std::clamp(0.0, joint.min_rad, joint.max_rad));
  }
  return angles;
}

void HandKinematics::SetAngles(std::span<const double> angle_rad) {
  GAUNTLET_ASSERT(angle_rad.size() == joints_.size());
  for (std::size_t i = 0; i < joints_.size(); ++i) data_->qpos[joints_[i].qpos] = angle_rad[i];
  for (const Follower& follower : followers_) {
    data_->qpos[follower.qpos] = follower.Angle(data_->qpos[follower.leader_qpos]);
  }
  mj_kinematics(model_.get(), data_.get());
  mj_comPos(model_.get(), data_.get());
}

Vector3d HandKinematics::Anchor(int hinge) const { return PlaceAt(data_->xanchor, hinge); }

Vector3d HandKinematics::TipInWorld(const Digit& digit) const {
  return PlaceAt(data_->xpos, digit.tip_body) +
         Eigen::Map<const RowMatrix3>(data_->xmat + 9 * digit.tip_body) * digit.tip_in_body_m;
}

Vector3d HandKinematics::Tip(int finger) const {
  return to_frame_ * (TipInWorld(digits_[finger]) - origin_m_);
}

Vector3d HandKinematics::TipDirection(int finger) const {
  const Digit& digit = digits_[finger];
  return to_frame_ * (TipInWorld(digit) - Anchor(digit.hinges.front())).normalized();
}

/// The base of a digit and its length, in the world and at the posture that is set.
void HandKinematics::Measure(int finger) {
  constexpr double kParallel = 0.9;
  constexpr std::size_t kFlexions = 3;  // MCP, PIP, DIP
  Digit& digit = digits_[finger];
  std::size_t base = digit.hinges.size() - 1;
  if (finger != kThumb) {
    const Vector3d flexion = PlaceAt(data_->xaxis, digit.hinges.front());
    std::size_t found = 0;
    for (std::size_t i = 0; i < digit.hinges.size() && found < kFlexions; ++i) {
      if (std::abs(PlaceAt(data_->xaxis, digit.hinges[i]).dot(flexion)) < kParallel) continue;
      base = i;
      ++found;
    }
  }
  digit.base_m = Anchor(digit.hinges[base]);
  digit.length_m = 0.0;
  Vector3d outer = TipInWorld(digit);
  for (std::size_t i = 0; i <= base; ++i) {
    digit.length_m += (outer - Anchor(digit.hinges[i])).norm();
    outer = Anchor(digit.hinges[i]);
  }
}

void HandKinematics::FindFrame() {
  SetAngles(NeutralAngles());
  Vector3d along = Vector3d::Zero();
  int first = 0;
  int last = 0;
  for (int finger = 0; finger < kFingers; ++finger) {
    if (!digits_[finger].exists) continue;
    Measure(finger);
    if (finger == kThumb) continue;
    along += (TipInWorld(digits_[finger]) - digits_[finger].base_m).normalized();
    first = first == 0 ? finger : first;
    last = finger;
  }
  const Vector3d x = along.normalized();
  const Vector3d across = digits_[first].base_m - digits_[last].base_m;
  const Vector3d y = (across - across.dot(x) * x).normalized();
  Vector3d z = x.cross(y);
  std::array<Vector3d, kFingers> tip;
  for (int finger = 0; finger < kFingers; ++finger) tip[finger] = TipInWorld(digits_[finger]);
  std::vector<double> bent;
  for (const HandJoint& joint : joints_) bent.push_back(0.5 * (joint.min_rad + joint.max_rad));
  SetAngles(bent);
  double raised = 0.0;  // of the fingertips, as they bend towards the palm
  for (int finger = kIndex; finger < kFingers; ++finger) {
    if (digits_[finger].exists) raised += (TipInWorld(digits_[finger]) - tip[finger]).dot(z);
  }
  if (raised > 0.0) z = -z;
  SetAngles(NeutralAngles());
  to_frame_ << x.transpose(), y.transpose(), z.transpose();
  origin_m_ = PlaceAt(data_->xpos, palm_);
  for (Digit& digit : digits_) digit.base_m = to_frame_ * (digit.base_m - origin_m_);
}

Eigen::Matrix3Xd HandKinematics::PointDerivative(int body, const Vector3d& point_m) const {
  using RowMatrix = Eigen::Matrix<double, 3, Eigen::Dynamic, Eigen::RowMajor>;
  RowMatrix all(3, model_->nv);
  mj_jac(model_.get(), data_.get(), all.data(), nullptr, point_m.data(), body);
  Eigen::Matrix3Xd derivative(3, joints_.size());
  for (std::size_t i = 0; i < joints_.size(); ++i) {
    derivative.col(static_cast<Eigen::Index>(i)) = all.col(joints_[i].dof);
    for (const Follower& follower : followers_) {
      if (follower.leader_qpos != joints_[i].qpos) continue;
      derivative.col(static_cast<Eigen::Index>(i)) +=
          follower.Slope(data_->qpos[follower.leader_qpos]) * all.col(follower.dof);
    }
  }
  return derivative;
}

Eigen::Matrix3Xd HandKinematics::TipDerivative(int finger) const {
  const Digit& digit = digits_[finger];
  return to_frame_ * PointDerivative(digit.tip_body, TipInWorld(digit));
}

Eigen::Matrix3Xd HandKinematics::TipDirectionDerivative(int finger) const {
  const Digit& digit = digits_[finger];
  const Vector3d tip = TipInWorld(digit);
  const Vector3d joint = Anchor(digit.hinges.front());
  // The axis of the last joint passes through its anchor: that moves with the body, too.
  const Eigen::Matrix3Xd apart =
      PointDerivative(digit.tip_body, tip) - PointDerivative(digit.tip_body, joint);
  return to_frame_ * apart / (tip - joint).norm();
}

void HandKinematics::FindGaps(double below_m, std::vector<Digits::Gap>& gaps) const {
  capsules_.FindGaps(*data_, below_m, gaps);
}

std::optional<Digits::Gap> HandKinematics::PinchGap(int finger) const {
  return capsules_.GapOf(*data_, digits_[kThumb].tip_geom, digits_[finger].tip_geom);
}

Eigen::RowVectorXd HandKinematics::GapDerivative(const Digits::Gap& gap) const {
  const Vector3d first = PlaceAt(gap.point_m[0], 0);
  const Vector3d second = PlaceAt(gap.point_m[1], 0);
  const Vector3d apart = first - second;
  const double distance_m = apart.norm();
  if (!(distance_m > 0.0)) return Eigen::RowVectorXd::Zero(std::ssize(joints_));
  return apart.transpose() / distance_m *
         (PointDerivative(gap.body[0], first) - PointDerivative(gap.body[1], second));
}

double HandKinematics::Overlap() const { return capsules_.Overlap(*data_); }

}  // namespace gauntlet::sim
