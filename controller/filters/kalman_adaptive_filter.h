#pragma once

#include <memory>
#include <string_view>

#include "controller/filters/filter.h"
#include "controller/filters/kalman_noise.h"
#include "controller/filters/start.h"
#include "controller/settings.h"

namespace gauntlet::controller {

/// The Kalman filter of KalmanConfig that learns R and q of every channel while it runs.
///
///     innovation e = z - H x^-,  residual d = z - H x
///     R <- R + (d^2 + H P H' - R) / memory
///     q <- q + (K_2^2 e^2 / F_22 - q) / memory         Q = q F, F from `process_noise`
///
/// where d^2 + H P H' counts at most as 25 R and K_2^2 e^2 / F_22 at most as 25 q (five standard
/// deviations). Both are what a filter that fits its signal keeps unchanged on average: E[d^2] = R
/// - H P H', and K S K' = Q in the velocity's place. `r` and `q` are where it starts; neither
/// leaves start / range .. start x range, so that a long rest cannot switch the filter off.
///
/// Source: Mohamed, Schwarz, Journal of Geodesy 73 (1999); Akhlaghi, Zhou, Huang, IEEE PES (2017).
/// Errors: as KalmanConfig, and a `q` that is not above 0.
struct KalmanAdaptiveConfig {
  static constexpr std::string_view kKind = "kalman_adaptive";
  static constexpr std::string_view kSummary = "Kalman filter that learns R and Q while running";

  Start start = Start::kFirst;
  KalmanNoise noise = {};
  double memory = 1000.0;
  double range = 1e6;
  bool adapt_r = true;
  bool adapt_q = true;

  void Visit(SettingsVisitor& visitor);
};

/// The filter, with what it has learned.
class KalmanAdaptiveFilter : public Filter {
 public:
  virtual double r(int channel) const noexcept = 0;
  virtual double q(int channel) const noexcept = 0;
};

std::unique_ptr<KalmanAdaptiveFilter> MakeKalmanAdaptiveFilter(const KalmanAdaptiveConfig& config,
                                                               int channel_count, double rate_hz);
std::unique_ptr<Filter> MakeFilter(const KalmanAdaptiveConfig& config, int channel_count,
                                   double rate_hz);

}  // namespace gauntlet::controller
