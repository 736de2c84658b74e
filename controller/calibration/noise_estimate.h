#pragma once

#include <Eigen/Core>
#include <vector>

namespace gauntlet::controller {

/// A stretch of samples [begin, end) in which the wearer held still.
struct StillStretch {
  Eigen::Index begin = 0;
  Eigen::Index end = 0;
};

/// Stretches of at least `min_duration_s` in which no channel moves: means over 50 ms stay where
/// the stretch began and where the last one was, within what the noise of each channel allows. The
/// 50 ms beside a motion are left out.
///
/// The noise is judged from differences of neighbouring samples, which motion hardly touches.
/// Shapes: `counts` is samples x channels, finite. Errors: none; no stretch is an empty list.
std::vector<StillStretch> FindStillStretches(const Eigen::MatrixXd& counts, double rate_hz,
                                             double min_duration_s = 0.5);

/// The measurement covariance R, estimated from a hand that holds still.
struct NoiseEstimate {
  Eigen::MatrixXd covariance;    // counts^2, channels x channels
  Eigen::VectorXd variance;      // its diagonal: the `r` of a Kalman filter
  Eigen::VectorXd variance_low;  // confidence interval of each variance
  Eigen::VectorXd variance_high;
  Eigen::MatrixXd covariance_low;  // the same for each element of the covariance
  Eigen::MatrixXd covariance_high;
  Eigen::VectorXd correlation;  // of neighbouring samples; 0 for white noise
  double degrees_of_freedom = 0.0;
};

struct NoiseEstimateOptions {
  double confidence = 0.95;
  /// Rounding to steps of this size adds step^2 / 12, which is not noise of the sensor and is taken
  /// off the variances (Sheppard 1898). 0 for values that were not rounded.
  double resolution_counts = 1.0;
};

/// Pools the stretches, each around its own mean.
///
///     R = sum over stretches and samples of (z - mean)(z - mean)' / f,  f = sum of (samples - 1)
///     f R_ii / variance is chi-squared with f_i = f (1 - c_i^2) / (1 + c_i^2) degrees of freedom,
///     c_i the correlation of neighbouring samples: noise that is not white tells less
///     R_ij is normal with variance (R_ii R_jj + R_ij^2) / sqrt(f_i f_j)
///
/// Source: Bartlett (1946) for f_i; Wilson, Hilferty (1931) for the quantiles of chi-squared, which
/// are right to 0.5 % from 10 degrees of freedom on.
/// Shapes: `counts` is samples x channels. Units: counts.
/// Errors: SettingError for fewer than two samples in all stretches, or values that are not finite.
NoiseEstimate EstimateNoise(const Eigen::MatrixXd& counts,
                            const std::vector<StillStretch>& stretches,
                            const NoiseEstimateOptions& options = {});

/// Quantile of the standard normal law, to about 1e-14. `probability` between 0 and 1.
double NormalQuantile(double probability);
/// Quantile of chi-squared over its degrees of freedom (Wilson, Hilferty).
double ChiSquaredQuantileRatio(double probability, double degrees_of_freedom);

}  // namespace gauntlet::controller
