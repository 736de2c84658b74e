#pragma once

#include <string_view>

#include "controller/export.h"
#include "controller/filters/kalman_noise.h"
#include "controller/filters/start.h"
#include "controller/settings.h"

namespace gauntlet::controller {

/// Fixed-lag smoother: the best estimate of the position `lag` samples ago, given all samples up to
/// now. Buys less noise with a known delay.
///
/// Runs the Kalman filter of KalmanConfig. For each of the last samples it keeps the estimate and
/// c = [c_1 c_2], the covariance of its error with that of the filter's prediction [q w]:
///
///     estimate <- estimate + c_1 (z - H x^-) / S,   c <- c (I - K H)' A'
///
/// Until `lag` samples have passed it gives the estimate of the first one.
/// Source: Anderson, Moore, Optimal Filtering (1979), section 7.3. Errors: as KalmanConfig.
struct GAUNTLET_API FixedLagConfig {
  static constexpr std::string_view kKind = "fixed_lag";
  static constexpr std::string_view kSummary = "Kalman smoother with a fixed delay";

  Start start = Start::kFirst;
  KalmanNoise noise = {};
  int lag = 10;

  void Visit(SettingsVisitor& visitor);
};

}  // namespace gauntlet::controller
