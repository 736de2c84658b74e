#pragma once

#include <Eigen/Core>

#include "controller/filters/kalman_steady_filter.h"

namespace gauntlet::controller {

/// The settled gains in steps of one sample, channels x states. Errors: as KalmanSteadyConfig.
Eigen::ArrayXXd SteadyGains(const KalmanSteadyConfig& config, int channel_count, double rate_hz);

}  // namespace gauntlet::controller
