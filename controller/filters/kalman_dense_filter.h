#pragma once

#include <string_view>
#include <vector>

#include "controller/export.h"
#include "controller/filters/kalman_noise.h"
#include "controller/filters/start.h"
#include "controller/settings.h"

namespace gauntlet::controller {

/// The paper's block form: all n channels in one filter of 2n states, so that noise and motion of
/// different channels may be correlated.
///
///     A = [I I; 0 I],  H = [I 0],  S = H P^- H' + R,  K = P^- H' S^-1
///
/// `r`: 1, n, or n^2 values (the full R, row after row). `q`: 1, n, or n^2 values (covariance
/// between channels, for positions and velocities alike), or 4 n^2 (the full Q, positions first).
/// With diagonal R and Q it gives what KalmanConfig gives, at hundreds of times the cost.
///
/// Source: Bai, Jiang, Yokoi, section 2.3.1. Errors: SettingError for other numbers of values, an R
/// that is not symmetric and positive definite, a Q that is not symmetric and positive
/// semi-definite, or more than 128 channels (a step would have to allocate).
struct GAUNTLET_API KalmanDenseConfig {
  static constexpr std::string_view kKind = "kalman_dense";
  static constexpr std::string_view kSummary =
      "Kalman filter over all channels together, with full R and Q";

  Start start = Start::kFirst;
  std::vector<double> r = PaperMeasurementVariance();
  std::vector<double> q = {1.0};

  void Visit(SettingsVisitor& visitor);
};

}  // namespace gauntlet::controller
