#pragma once

#include <Eigen/Core>
#include <optional>

#include "controller/export.h"
#include "controller/filters/filter_config.h"
#include "controller/filters/kalman_steady_filter.h"

namespace gauntlet::controller {

/// The settled gains in steps of one sample, channels x states. Errors: as KalmanSteadyConfig.
Eigen::ArrayXXd SteadyGains(const KalmanSteadyConfig& config, int channel_count, double rate_hz);

/// Gains on position, velocity and acceleration in steps of one sample, channels x 3, of a filter
/// that is described by them and starts at its first sample:
///
///     x' = x + v + a / 2,  v' = v + a,  e = z - x',  x = x' + k1 e,  v = v' + k2 e,  a = a + k3 e
///
/// None for all other filters. Errors: as the filter's.
GAUNTLET_API std::optional<Eigen::ArrayXXd> ConstantGains(const FilterSettings& settings,
                                                          int channel_count, double rate_hz);

}  // namespace gauntlet::controller
