#pragma once

#include <Eigen/Core>
#include <type_traits>
#include <vector>

#include "controller/filters/per_channel.h"
#include "controller/settings.h"

namespace gauntlet::controller {

inline constexpr double kMostHorizon_ms = 1000.0;

/// The setting that every prediction has.
inline void VisitHorizon(SettingsVisitor& visitor, std::vector<double>& horizon_ms) {
  visitor.Numbers({"horizon_ms", "how far to look ahead, one for all channels or one for each", 0,
                   kMostHorizon_ms},
                  horizon_ms);
}

/// Horizon in steps of the predictor, per channel. Errors: SettingError.
inline Eigen::ArrayXd HorizonSteps(const std::vector<double>& horizon_ms, int channel_count,
                                   double rate_hz) {
  return PerChannel("horizon_ms", horizon_ms, channel_count) * 1e-3 * rate_hz;
}

/// Horizon in the settings of a kind of prediction; null for a kind without, and, to change it, for
/// one whose weights were fitted for it.
template <class Settings>
auto* HorizonOf(Settings& settings) {
  using Values =
      std::conditional_t<std::is_const_v<Settings>, const std::vector<double>, std::vector<double>>;
  Values* horizon_ms = nullptr;
  constexpr bool kIsFixed = !std::is_const_v<Settings> && requires { settings.weights; };
  if constexpr (requires { settings.horizon_ms; } && !kIsFixed) horizon_ms = &settings.horizon_ms;
  return horizon_ms;
}

}  // namespace gauntlet::controller
