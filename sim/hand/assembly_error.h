#pragma once

#include <vector>

#include "sim/hand/drive.h"
#include "sim/hand/hand_config.h"
#include "sim/hand/hand_joint.h"

namespace gauntlet::sim {

/// Makes the drives what a workshop made of the drawing: drum radii, moment arms (one error for all
/// cables of a motor at a joint) and lengths of cables. With all errors 0 nothing changes.
///
/// Returns per joint how far it is from the middle of its range when all spools are at theirs
/// [rad]: cables were fixed in that posture.
std::vector<double> AssembleWithErrors(const AssemblyErrorConfig& config,
                                       const std::vector<HandJoint>& joints,
                                       const std::vector<Follower>& followers,
                                       std::vector<Drive>& drives);

}  // namespace gauntlet::sim
