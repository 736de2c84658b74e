#pragma once

#include <Eigen/Core>
#include <vector>

#include "sim/fit/retarget/frame_problem.h"

namespace gauntlet::sim {

/// Angles with the least sum of the costs of all frames and of S |q''|^2, q'' the second difference
/// over time, from `angles_rad` to the next minimum.
///
/// Gauss-Newton with Levenberg's damping on all frames at once; the equations are banded, since
/// three neighbouring frames share a term. Bounds hold a joint as in FrameProblem.
/// Shapes: a row per frame, times rise. Units: S in m^2 s^4/rad^2.
Eigen::MatrixXd SmoothMotion(FrameProblem& problem,
                             const std::vector<const FingertipFrame*>& frames,
                             const std::vector<double>& time_s, double acceleration_weight,
                             Eigen::MatrixXd angles_rad);

}  // namespace gauntlet::sim
