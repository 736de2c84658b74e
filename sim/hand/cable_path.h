#pragma once

#include <memory>
#include <vector>

#include "sim/hand/drive.h"

namespace gauntlet::sim {

/// Finds out from the model what every cable does on its way: which joints it passes, with which
/// moment arms, and how much it bends.
class CablePaths {
 public:
  CablePaths(const mjModel_& model, const std::vector<HandJoint>& joints,
             const std::vector<Follower>& followers);

  /// Fills crossings, bends and length at the reference.
  void Trace(Cable& cable) const;

 private:
  struct Bend {
    double position[3];
    double angle_rad;  // of this bend alone
  };
  std::vector<Bend> BendsOf(int tendon) const;
  bool Passes(int tendon, int dof) const;

  const mjModel_& model_;
  std::unique_ptr<mjData_, void (*)(mjData_*)> data_;  // at the reference posture
  std::vector<double> largest_arm_m_;                  // tendons x dofs, over many postures
};

}  // namespace gauntlet::sim
