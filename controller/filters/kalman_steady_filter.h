#pragma once

#include <string_view>

#include "controller/export.h"
#include "controller/filters/kalman_noise.h"
#include "controller/filters/start.h"
#include "controller/settings.h"

namespace gauntlet::controller {

/// The Kalman filter of KalmanConfig with the gain to which it settles, from the first sample on.
///
///     K = P H' / (H P H' + R)  with P from the Riccati equation, see SolveRiccati()
///
/// The covariance does not depend on the data, so after some tens of samples both give the same;
/// this one costs half. Errors: as KalmanConfig, and a `q` that is not above 0: without process
/// noise the gain settles to 0.
struct GAUNTLET_API KalmanSteadyConfig {
  static constexpr std::string_view kKind = "kalman_steady";
  static constexpr std::string_view kSummary = "Kalman filter with its settled gain";

  Start start = Start::kFirst;
  KalmanNoise noise = {};
  int states = 2;

  void Visit(SettingsVisitor& visitor);
};

}  // namespace gauntlet::controller
