#pragma once

#include <Eigen/Core>
#include <vector>

namespace gauntlet::controller {

/// Noise of one channel, from stretches in which only noise changes its values.
///
///     c_l = correlation of samples that are l apart
///     a mean of n samples has the variance V(n) variance / n, V(n) = 1 + 2 sum of (1 - l/n) c_l
///     their variance is known as that of 1/W as many independent ones, W = 1 + 2 sum of c_l^2
///
/// Source: Bartlett (1946).
struct ChannelNoise {
  double variance = 0.0;  // rounding included
  /// c_1, c_2, .. up to the first that may be 0 by chance; none for white noise.
  std::vector<double> correlation;
  double samples = 0.0;             // that were not left out
  double degrees_of_freedom = 0.0;  // of the variance: its relative variance is 2 over this

  double MeanFactor(double sample_count) const;  // V(n)
  double VarianceFactor() const;                 // W
};

/// Each stretch counts around its own mean, which is taken into account: of the sum of squares of n
/// samples the mean takes V(n) variances away.
///
/// Shapes: one value per sample; NaN is left out. `rounding_variance` is part of the variance and
/// white.
ChannelNoise DescribeNoise(const std::vector<Eigen::VectorXd>& stretches, double rounding_variance);

}  // namespace gauntlet::controller
