#include "sim/hand/follower.h"

#include <mujoco/mujoco.h>

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

std::vector<Follower> FindFollowers(const mjModel& model) {
  std::vector<Follower> followers;
  for (int index = 0; index < model.neq; ++index) {
    const int joint = model.eq_obj1id[index];
    const int leader = model.eq_obj2id[index];
    if (model.eq_type[index] != mjEQ_JOINT || !model.eq_active[index] || leader < 0) continue;
    Follower follower{.qpos = model.jnt_qposadr[joint],
                      .dof = model.jnt_dofadr[joint],
                      .leader_qpos = model.jnt_qposadr[leader],
                      .leader_dof = model.jnt_dofadr[leader]};
    follower.zero_rad = model.qpos0[follower.qpos];
    follower.leader_zero_rad = model.qpos0[follower.leader_qpos];
    for (int power = 0; power < 5; ++power) {
      follower.coefficient[power] = model.eq_data[index * mjNEQDATA + power];
    }
    followers.push_back(follower);
  }
  return followers;
}

}  // namespace gauntlet::sim
