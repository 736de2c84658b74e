#pragma once

#include <memory>
#include <vector>

#include "sim/hand/drive.h"

namespace gauntlet::sim {

/// True if the joint turns the body.
bool Turns(const mjModel_& model, int joint, int body);

/// Finds out from the model what every cable does on its way: which joints it passes, with which
/// moment arms, and how much it bends.
class CablePaths {
 public:
  CablePaths(const mjModel_& model, const std::vector<HandJoint>& joints,
             const std::vector<Follower>& followers);

  /// Fills branches, crossings, bends and length at the reference.
  /// Errors: UserError for friction of a cable of which two branches pass the same joint.
  void Trace(Cable& cable) const;

 private:
  struct Bend {
    double position[3];
    double angle_rad;  // of this bend alone
  };
  std::vector<Bend> BendsOf(int begin, int end) const;
  bool Passes(int tendon, int dof) const;
  bool Passes(int begin, int end, int joint) const;
  void TraceBranch(int begin, int end, const std::vector<Bend>& bends, Cable& cable) const;

  const mjModel_& model_;
  std::unique_ptr<mjData_, void (*)(mjData_*)> data_;  // at the reference posture
  std::vector<double> largest_arm_m_;                  // tendons x dofs, over many postures
};

}  // namespace gauntlet::sim
