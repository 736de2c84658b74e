#pragma once

#include <string_view>

#include "controller/export.h"
#include "controller/filters/kalman_noise.h"
#include "controller/filters/start.h"
#include "controller/settings.h"

namespace gauntlet::controller {

/// The paper's Kalman filter, one per channel, with the covariance computed at every step until it
/// has settled to the rounding of its last digits.
///
///     x = [q w]',  A = [1 1; 0 1],  B = [0.5; 1],  H = [1 0],  unit step
///     x_j^- = A x_{j-1} + B u_j            P_j^- = A P_{j-1} A' + Q
///     K_j   = P_j^- H' / (H P_j^- H' + R)
///     x_j   = x_j^- + K_j (z_j - H x_j^-)  P_j   = (I - K_j H) P_j^-
///
/// The paper prints K_j with P_j; the standard form, used here, has the a-priori P_j^-. Without
/// other settings it is the paper's filter: Q = I, R as measured there, no acceleration input.
/// On the robot u may come from outside (StepWithAcceleration); with `acceleration_window` it is
/// the second derivative of the best parabola through that many last samples, 0 until there are so
/// many. With three states A = [1 1 1/2; 0 1 1; 0 0 1] and the acceleration is estimated, too.
///
/// Source: Bai, Jiang, Yokoi, sections 2.3 and 2.4. Units: r in the input's unit squared.
/// Errors: SettingError if `r` or `q` has neither one value nor one per channel. The default `r`
/// has the paper's 18 values, so another number of channels needs its own.
struct GAUNTLET_API KalmanConfig {
  static constexpr std::string_view kKind = "kalman";
  static constexpr std::string_view kSummary =
      "Kalman filter of the paper: constant velocity, covariance at every step";

  Start start = Start::kFirst;
  KalmanNoise noise = {};
  int states = 2;
  int acceleration_window = 0;

  void Visit(SettingsVisitor& visitor);
};

}  // namespace gauntlet::controller
