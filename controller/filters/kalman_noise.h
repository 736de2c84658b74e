#pragma once

#include <Eigen/Core>
#include <vector>

#include "controller/filters/paper_noise.h"
#include "controller/filters/process_noise.h"
#include "controller/settings.h"

namespace gauntlet::controller {

/// What all Kalman filters are told of the noise: R and Q, one value for all channels or one each.
struct KalmanNoise {
  std::vector<double> r = PaperMeasurementVariance();
  std::vector<double> q = {1.0};
  ProcessNoise process_noise = ProcessNoise::kIdentity;

  /// The keys `r`, `q` and `process_noise`, without a group around them.
  void Visit(SettingsVisitor& visitor);
};

/// `r` with one value per channel. Errors: SettingError, which says so if the paper's 18 values
/// meet another number of channels.
Eigen::ArrayXd MeasurementVariance(const KalmanNoise& noise, int channel_count);
/// `q` with one value per channel. Errors: SettingError.
Eigen::ArrayXd ProcessVariance(const KalmanNoise& noise, int channel_count);

}  // namespace gauntlet::controller
