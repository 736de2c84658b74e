#pragma once

#include <string_view>

#include "controller/export.h"
#include "controller/settings.h"

namespace gauntlet::controller {

/// Position and velocity with constant gains: what a Kalman filter becomes, with gains by hand.
///
///     x^- = x(k-1) + v(k-1),  e = z(k) - x^-,  x(k) = x^- + alpha e,  v(k) = v(k-1) + beta e
///
/// in steps of one sample; starts at x = z(0), v = 0.
/// Source: Kalata, IEEE TAES 20 (1984); stable for 0 < alpha, 0 < beta, 2 alpha + beta < 4.
/// Errors: SettingError for gains with which the filter is not stable.
struct GAUNTLET_API AlphaBetaConfig {
  static constexpr std::string_view kKind = "alpha_beta";
  static constexpr std::string_view kSummary = "position and velocity with constant gains";

  // Critically damped: beta = 2 (2 - alpha) - 4 sqrt(1 - alpha). An assumption of what suits a
  // hand.
  double alpha = 0.1;
  double beta = 0.0053;

  void Visit(SettingsVisitor& visitor);
};

/// Position, velocity and, as a third state, acceleration with constant gains.
///
///     x^- = x + v + a/2,  v^- = v + a,  e = z - x^-
///     x = x^- + alpha e,  v = v^- + beta e,  a = a + 2 gamma e
///
/// Source: Brookner, Tracking and Kalman Filtering Made Easy (1998), g-h-k filter; stable as above
/// and for gamma < alpha beta / (2 - alpha).
/// Errors: SettingError for gains with which the filter is not stable.
struct GAUNTLET_API AlphaBetaGammaConfig {
  static constexpr std::string_view kKind = "alpha_beta_gamma";
  static constexpr std::string_view kSummary =
      "position, velocity and acceleration with constant gains";

  // Critically damped, three poles at 0.95: alpha = 1 - p^3, beta = 1.5 (1-p)^2 (1+p),
  // gamma = (1-p)^3 / 2.
  double alpha = 0.142625;
  double beta = 0.0073125;
  double gamma = 6.25e-5;

  void Visit(SettingsVisitor& visitor);
};

}  // namespace gauntlet::controller
