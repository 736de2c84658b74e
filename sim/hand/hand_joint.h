#pragma once

#include <string>
#include <vector>

#include "sim/hand/engine_types.h"
#include "sim/hand/follower.h"

namespace gauntlet::sim {

/// A joint of the hand that stands for itself: no spool, and not led by another joint.
struct HandJoint {
  std::string name;
  int joint = 0;  // in the model
  int qpos = 0;
  int dof = 0;
  double min_rad = 0.0;
  double max_rad = 0.0;
  bool limited = false;

  double reference_rad() const { return limited ? 0.5 * (min_rad + max_rad) : 0.0; }
};

/// Place of a joint in the way from the world to the fingertips.
enum class JointGroup {
  kFinger,  // moves a digit against the palm; of a hand without a palm, each joint
  kWrist,   // moves the palm, by a motor of `hand.servo`
  kArm,     // moves the palm, by a motor of `hand.arm_servo`
};

/// The hinges and slides of the model that neither carry a spool (`spool_qpos`) nor follow, in the
/// model's order; also those that no cable moves.
std::vector<HandJoint> FindJoints(const mjModel_& model, const std::vector<Follower>& followers,
                                  const std::vector<int>& spool_qpos);

/// All positions with the joints as given [rad], followers included, spools at 0.
std::vector<double> PostureOf(const mjModel_& model, const std::vector<HandJoint>& joints,
                              const std::vector<double>& joint_angle_rad,
                              const std::vector<Follower>& followers);

}  // namespace gauntlet::sim
