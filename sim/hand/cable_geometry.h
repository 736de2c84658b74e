#pragma once

#include <vector>

#include "sim/hand/drive.h"

namespace gauntlet::sim {

/// Writes the length of every cable as a sum of functions of one joint angle each
/// (Cable::spans), so that no step needs the engine to follow its way through space.
///
/// Possible where between two guides there is at most one joint, a hinge, and pulleys are cylinders
/// on the axis of the hinge that they belong to. The result is compared with the engine over the
/// whole range of all joints. `joints` as for FindCables(), which comes before.
///
/// Returns false if some cable is something else, and leaves no spans: the engine has to measure.
bool FindCableSpans(const mjModel_& model, const std::vector<HandJoint>& joints,
                    const std::vector<Follower>& followers, std::vector<Drive>& drives);

/// Length of a cable [m] with the model's positions as given, from its spans. `arm_m` gets the
/// moment arm of each crossing, and `rate_m_s` how fast the length grows at these speeds.
double MeasureCable(const Cable& cable, const double* qpos, const double* qvel,
                    std::span<double> arm_m, double& rate_m_s) noexcept;

}  // namespace gauntlet::sim
