#pragma once

#include <string>
#include <vector>

#include "sim/hand/engine_types.h"

namespace gauntlet::sim {

/// A joint without a motor of its own that follows another one by a linkage:
///
///     angle = zero + sum_k coefficient[k] (leader - leader_zero)^k
struct Follower {
  int qpos = 0;
  int dof = 0;
  int leader_qpos = 0;
  double zero_rad = 0.0;
  double leader_zero_rad = 0.0;
  double coefficient[5] = {};

  double Angle(double leader_rad) const noexcept;
  double Slope(double leader_rad) const noexcept;
};

/// Name of the joint with this position in qpos; empty for one without a name.
std::string JointNameAt(const mjModel_& model, int qpos);

/// Joints of the model that follow another by an equality constraint. The leader of each follows
/// none: where a joint follows a follower, in proportion, the two linkages become one.
/// Errors: UserError for a joint that follows two others, or itself by a loop of linkages.
std::vector<Follower> FindFollowers(const mjModel_& model);

}  // namespace gauntlet::sim
