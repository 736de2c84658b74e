#pragma once

#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "controller/export.h"
#include "controller/filters/alpha_beta_filter.h"
#include "controller/filters/butterworth_filter.h"
#include "controller/filters/exponential_filter.h"
#include "controller/filters/external_filter.h"
#include "controller/filters/fixed_lag_filter.h"
#include "controller/filters/jerk_limit_filter.h"
#include "controller/filters/kalman_adaptive_filter.h"
#include "controller/filters/kalman_dense_filter.h"
#include "controller/filters/kalman_filter.h"
#include "controller/filters/kalman_steady_filter.h"
#include "controller/filters/median_filter.h"
#include "controller/filters/moving_average_filter.h"
#include "controller/filters/no_filter.h"
#include "controller/filters/one_euro_filter.h"
#include "controller/filters/savitzky_golay_filter.h"
#include "controller/kinds.h"
#include "controller/settings.h"

namespace gauntlet::controller {

/// Every kind of filter that there is. To add one: a file with its config (kKind, kSummary,
/// defaults, Visit) and its MakeFilter(), one entry here and one in `filter_registry.h`.
class GAUNTLET_API FilterSettings
    : public std::variant<NoFilterConfig, MovingAverageConfig, MedianConfig, HampelConfig,
                          ExponentialConfig, ButterworthConfig, SavitzkyGolayConfig, OneEuroConfig,
                          JerkLimitConfig, AlphaBetaConfig, AlphaBetaGammaConfig, KalmanConfig,
                          KalmanSteadyConfig, KalmanAdaptiveConfig, KalmanDenseConfig,
                          FixedLagConfig, ExternalConfig> {
 public:
  using variant::variant;
  FilterSettings();
  FilterSettings(const FilterSettings& other);
  FilterSettings(FilterSettings&& other) noexcept;
  FilterSettings& operator=(const FilterSettings& other);
  FilterSettings& operator=(FilterSettings&& other) noexcept;
  ~FilterSettings();
};

/// Values of one number for the channels of a filter, in place of one value for all.
struct GAUNTLET_API ChannelValues {
  std::string key;
  std::vector<double> values;
};

/// A filter as a person writes it: `kind`, then the settings of that kind. Every single number of a
/// kind also takes a list with a value for each of the filter's channels.
struct GAUNTLET_API FilterConfig {
  FilterSettings settings;
  /// Names of the channels that it filters, or their numbers from 1; empty: all. Other channels
  /// pass unchanged.
  std::vector<std::string> channels = {};
  std::vector<ChannelValues> per_channel = {};

  std::string_view kind() const { return KindName(settings); }
  void Visit(SettingsVisitor& visitor);
};

/// All kinds that this library computes, in the order of every list and table.
using FilterKind = Kind<FilterConfig>;
GAUNTLET_API std::span<const FilterKind> FilterKinds();
/// These kinds and, at the end, `external`, which only a caller can make.
GAUNTLET_API std::span<const FilterKind> AllFilterKinds();

}  // namespace gauntlet::controller
