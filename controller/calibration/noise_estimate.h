#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "controller/calibration/still_stretches.h"
#include "controller/export.h"

namespace gauntlet::controller {

/// The measurement covariance R, estimated from a hand that holds still.
struct GAUNTLET_API NoiseEstimate {
  std::vector<double> covariance;    // counts^2, channels x channels, row by row
  std::vector<double> variance;      // its diagonal: the `r` of a Kalman filter
  std::vector<double> variance_low;  // confidence interval of each variance
  std::vector<double> variance_high;
  std::vector<double> covariance_low;  // the same for each element of the covariance
  std::vector<double> covariance_high;
  std::vector<double> correlation;  // of neighbouring samples; 0 for white noise
  /// Per channel, samples that were left out: more than 5 standard deviations from the median of
  /// their stretch.
  std::vector<std::ptrdiff_t> spikes;
  /// Per channel, whether rounding hides so much that the variance is the most likely one behind it
  /// (EstimateRoundedNoise) and its interval is wide.
  std::vector<bool> rounded;
  double degrees_of_freedom = 0.0;
};

/// Options of EstimateNoise().
struct GAUNTLET_API NoiseEstimateOptions {
  double confidence = 0.95;
  /// Rounding to steps of this size adds step^2 / 12, which is not noise of the sensor and is taken
  /// off the variances (Sheppard 1898). That holds down to noise of 0.7 steps; below it, see
  /// NoiseEstimate::rounded. 0 for values that were not rounded.
  double resolution_counts = 1.0;
};

/// Pools the stretches, each around its own mean, without spikes.
///
///     R_ij = sum over stretches and samples of (z_i - mean_i)(z_j - mean_j) / sqrt(n_i n_j),
///     n_i = sum over stretches of (samples - V_i(samples)), see ChannelNoise
///     f_i R_ii / variance is chi-squared with f_i = f / W_i degrees of freedom,
///     f = sum of (samples - 1): noise that is not white tells less
///     R_ij is normal with variance (R_ii R_jj + R_ij^2) / sqrt(f_i f_j)
///
/// Source: Bartlett (1946) for f_i; Wilson, Hilferty (1931) for the quantiles of chi-squared, which
/// are right to 0.5 % from 10 degrees of freedom on.
/// Shapes: `counts` has all samples of the first channel, then those of the next, as many for each.
/// Units: counts. Errors: SettingError for another number of values, fewer than two samples in all
/// stretches, or values that are not finite.
GAUNTLET_API NoiseEstimate EstimateNoise(std::span<const double> counts, int channel_count,
                                         const std::vector<StillStretch>& stretches,
                                         const NoiseEstimateOptions& options = {});

/// Quantile of the standard normal law, to about 1e-14. `probability` between 0 and 1.
GAUNTLET_API double NormalQuantile(double probability);
/// Quantile of chi-squared over its degrees of freedom (Wilson, Hilferty).
GAUNTLET_API double ChiSquaredQuantileRatio(double probability, double degrees_of_freedom);

}  // namespace gauntlet::controller
