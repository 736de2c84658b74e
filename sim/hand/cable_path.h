#pragma once

#include <mujoco/mujoco.h>

#include <memory>
#include <vector>

#include "sim/hand/drive.h"

namespace gauntlet::sim {

/// Finds out from the model what every cable does on its way: which joints it passes, with which
/// moment arms, and how much it bends.
class CablePaths {
 public:
  CablePaths(const mjModel& model, const std::vector<int>& channel_joints,
             const std::vector<double>& reference_rad, const std::vector<Follower>& followers);

  /// Fills crossings, bends and length at the reference of the cable of this joint.
  void Trace(int own_joint, Cable& cable) const;

 private:
  struct Bend {
    double position[3];
    double angle_rad;  // of this bend alone
  };
  std::vector<Bend> BendsOf(int tendon) const;
  bool Passes(int tendon, int dof) const;
  bool Follows(int dof, int leader_dof) const;

  const mjModel& model_;
  const std::vector<Follower>& followers_;
  std::unique_ptr<mjData, void (*)(mjData*)> data_;  // at the reference posture
  std::vector<double> largest_arm_m_;                // tendons x dofs, over many postures
};

}  // namespace gauntlet::sim
