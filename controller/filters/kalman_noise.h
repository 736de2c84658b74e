#pragma once

#include <Eigen/Core>
#include <type_traits>
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

/// Whether `r` was left as it is by default: the paper's, for 18 channels in counts.
bool IsDefaultMeasurementVariance(const std::vector<double>& r);

/// The measurement variance among the settings of a filter; null where it has none.
template <class FilterConfig>
auto* MeasurementVarianceOf(FilterConfig& config) {
  using Values = std::conditional_t<std::is_const_v<FilterConfig>, const std::vector<double>,
                                    std::vector<double>>;
  Values* r = nullptr;
  if constexpr (requires { config.noise.r; }) r = &config.noise.r;
  if constexpr (requires { config.r; }) r = &config.r;
  return r;
}

/// `r` with one value per channel. Errors: SettingError, which says so if the paper's 18 values
/// meet another number of channels.
Eigen::ArrayXd MeasurementVariance(const KalmanNoise& noise, int channel_count);
/// `q` with one value per channel. Errors: SettingError.
Eigen::ArrayXd ProcessVariance(const KalmanNoise& noise, int channel_count);

}  // namespace gauntlet::controller
