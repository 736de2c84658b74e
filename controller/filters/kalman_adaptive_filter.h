#pragma once

#include <string_view>

#include "controller/export.h"
#include "controller/filters/kalman_noise.h"
#include "controller/filters/start.h"
#include "controller/settings.h"

namespace gauntlet::controller {

/// The Kalman filter of KalmanConfig that learns R and q of every channel while it runs.
///
///     e = z - H x^-,  S = H P^- H' + R
///     c_0 = mean of e(k)^2,  c_1 = mean of e(k) e(k-1)       over about `memory` samples
///     q / R  grows by 4 c_1 / (c_0 memory) of itself         right gains leave no correlation in e
///     both   grow by (c_0 / S - 1) / memory of themselves    then e is as large as S says
///
/// The size of e alone cannot tell R from q: any pair with the right S explains it. A sample at
/// m > 5 standard deviations counts as one at 25 / m: an outlier does not become the new normal.
/// `r` and `q` are where it starts; neither leaves start / range .. start x range, so that a long
/// rest cannot switch the filter off. With only one to learn, the correlation alone decides it.
///
/// Source: Mehra, IEEE TAC 15 (1970): white innovations as the test of R and Q; the rule that acts
/// on it, with the 4 for a damped approach, is ours.
/// Errors: as KalmanConfig, and a `q` that is not above 0.
struct GAUNTLET_API KalmanAdaptiveConfig {
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

}  // namespace gauntlet::controller
