#pragma once

#include <Eigen/Core>

#include "controller/filters/kalman_noise.h"

namespace gauntlet::controller {

/// `r` with one value per channel. Errors: SettingError, which says so if the paper's 18 values
/// meet another number of channels.
Eigen::ArrayXd MeasurementVariance(const KalmanNoise& noise, int channel_count);
/// `q` with one value per channel. Errors: SettingError.
Eigen::ArrayXd ProcessVariance(const KalmanNoise& noise, int channel_count);

}  // namespace gauntlet::controller
