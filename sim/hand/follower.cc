#include "sim/hand/follower.h"

#include <fmt/core.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <iterator>
#include <string>

#include "sim/base/error.h"
#include "sim/hand/mujoco_versions.h"

namespace gauntlet::sim {

double Follower::Angle(double leader_rad) const noexcept {
  const double x = leader_rad - leader_zero_rad;
  double sum = 0.0;
  for (int power = 4; power >= 0; --power) sum = sum * x + coefficient[power];
  return zero_rad + sum;
}

double Follower::Slope(double leader_rad) const noexcept {
  const double x = leader_rad - leader_zero_rad;
  double sum = 0.0;
  for (int power = 4; power >= 1; --power) sum = sum * x + power * coefficient[power];
  return sum;
}

std::string JointNameAt(const mjModel& model, int qpos) {
  for (int joint = 0; joint < model.njnt; ++joint) {
    const char* const name = mj_id2name(&model, mjOBJ_JOINT, joint);
    if (model.jnt_qposadr[joint] == qpos) return name == nullptr ? "" : name;
  }
  return "";
}

namespace {

/// Makes the follower of a follower one of its leader.
void Join(const mjModel& model, const Follower& inner, Follower& outer) {
  // The inner angle less its zero is a polynomial of what leads it.
  if (std::any_of(outer.coefficient + 2, std::end(outer.coefficient),
                  [](double c) { return c != 0.0; })) {
    throw UserError(fmt::format(
        "joint '{}' of the model follows '{}', which follows '{}': the first equality must be a "
        "constant ratio",
        JointNameAt(model, outer.qpos), JointNameAt(model, inner.qpos),
        JointNameAt(model, inner.leader_qpos)));
  }
  const double ratio = outer.coefficient[1];
  outer.coefficient[0] += ratio * (inner.coefficient[0] + inner.zero_rad - outer.leader_zero_rad);
  for (int power = 1; power < 5; ++power)
    outer.coefficient[power] = ratio * inner.coefficient[power];
  outer.leader_qpos = inner.leader_qpos;
  outer.leader_zero_rad = inner.leader_zero_rad;
}

/// Errors: see FindFollowers().
void JoinChains(const mjModel& model, std::vector<Follower>& followers) {
  for (Follower& follower : followers) {
    if (std::ranges::count(followers, follower.qpos, &Follower::qpos) > 1) {
      throw UserError(fmt::format("joint '{}' of the model follows two others by equalities",
                                  JointNameAt(model, follower.qpos)));
    }
    std::string way = JointNameAt(model, follower.qpos);
    for (std::size_t links = 0;; ++links) {
      way += ", " + JointNameAt(model, follower.leader_qpos);
      if (follower.leader_qpos == follower.qpos || links > followers.size()) {
        throw UserError(
            fmt::format("joint '{}' of the model drives itself by a loop of linkages: {}",
                        JointNameAt(model, follower.leader_qpos), way));
      }
      const auto inner = std::ranges::find(followers, follower.leader_qpos, &Follower::qpos);
      if (inner == followers.end()) break;
      Join(model, *inner, follower);
    }
  }
}

}  // namespace

std::vector<Follower> FindFollowers(const mjModel& model) {
  std::vector<Follower> followers;
  for (int index = 0; index < model.neq; ++index) {
    const int joint = model.eq_obj1id[index];
    const int leader = model.eq_obj2id[index];
    if (model.eq_type[index] != mjEQ_JOINT || !IsActive(model, index) || leader < 0) continue;
    Follower follower{.qpos = model.jnt_qposadr[joint],
                      .dof = model.jnt_dofadr[joint],
                      .leader_qpos = model.jnt_qposadr[leader]};
    follower.zero_rad = model.qpos0[follower.qpos];
    follower.leader_zero_rad = model.qpos0[follower.leader_qpos];
    for (int power = 0; power < 5; ++power) {
      follower.coefficient[power] = model.eq_data[index * mjNEQDATA + power];
    }
    followers.push_back(follower);
  }
  JoinChains(model, followers);
  return followers;
}

}  // namespace gauntlet::sim
