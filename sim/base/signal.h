#pragma once

#include <Eigen/Core>

namespace gauntlet::sim {

/// Samples x channels, column-major: the history of one channel is contiguous.
using Signal = Eigen::MatrixXd;
/// The same for integer commands.
using IntegerSignal = Eigen::Matrix<int, Eigen::Dynamic, Eigen::Dynamic>;

inline constexpr double kRadPerDeg = 3.14159265358979323846 / 180.0;
inline constexpr double kDegPerRad = 180.0 / 3.14159265358979323846;

}  // namespace gauntlet::sim
