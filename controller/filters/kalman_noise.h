#pragma once

#include <type_traits>
#include <vector>

#include "controller/export.h"
#include "controller/filters/paper_noise.h"
#include "controller/filters/process_noise.h"
#include "controller/settings.h"

namespace gauntlet::controller {

/// Noise settings of all Kalman filters: R and Q, one value for all channels or one each.
struct GAUNTLET_API KalmanNoise {
  std::vector<double> r = PaperMeasurementVariance();
  std::vector<double> q = {1.0};
  ProcessNoise process_noise = ProcessNoise::kIdentity;

  /// The keys `r`, `q` and `process_noise`, without a group around them.
  void Visit(SettingsVisitor& visitor);
};

/// True if `r` is the default: the paper's, for 18 channels in counts.
GAUNTLET_API bool IsDefaultMeasurementVariance(const std::vector<double>& r);

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

}  // namespace gauntlet::controller
