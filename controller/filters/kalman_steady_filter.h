#pragma once

#include <Eigen/Core>
#include <memory>
#include <string_view>

#include "controller/filters/filter.h"
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
struct KalmanSteadyConfig {
  static constexpr std::string_view kKind = "kalman_steady";
  static constexpr std::string_view kSummary = "Kalman filter with its settled gain";

  Start start = Start::kFirst;
  KalmanNoise noise = {};
  int states = 2;

  void Visit(SettingsVisitor& visitor);
};

/// The settled gains in steps of one sample, channels x states.
Eigen::ArrayXXd SteadyGains(const KalmanSteadyConfig& config, int channel_count, double rate_hz);

std::unique_ptr<Filter> MakeFilter(const KalmanSteadyConfig& config, int channel_count,
                                   double rate_hz);

}  // namespace gauntlet::controller
