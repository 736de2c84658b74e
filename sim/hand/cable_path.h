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

  /// Fills crossings, bends and length at the reference. `meant(dof)` tells whether the cable is
  /// meant to move a joint that it passes; a joint that follows counts as its leader.
  template <class Meant>
  void Trace(Cable& cable, const Meant& meant) const {
    Trace(cable);
    for (Crossing& crossing : cable.crossings) crossing.own = meant(LeaderOf(crossing.dof));
  }

 private:
  struct Bend {
    double position[3];
    double angle_rad;  // of this bend alone
  };
  void Trace(Cable& cable) const;
  std::vector<Bend> BendsOf(int tendon) const;
  bool Passes(int tendon, int dof) const;
  int LeaderOf(int dof) const;

  const mjModel_& model_;
  const std::vector<Follower>& followers_;
  std::unique_ptr<mjData_, void (*)(mjData_*)> data_;  // at the reference posture
  std::vector<double> largest_arm_m_;                  // tendons x dofs, over many postures
};

}  // namespace gauntlet::sim
