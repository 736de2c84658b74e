#pragma once

#include <Eigen/Core>
#include <vector>

namespace gauntlet::controller {

/// The variance of normal noise that was rounded to steps not much smaller than itself.
struct RoundedNoise {
  double variance = 0.0;
  double variance_low = 0.0;  // confidence interval
  double variance_high = 0.0;
};

/// Maximum likelihood: a value v is seen with the probability that v + noise lies within half a
/// step of it; every stretch has a mean of its own. The interval has all variances that are not
/// much less likely (profile likelihood, chi-squared of one degree of freedom). Values that all are
/// the same, or of two neighbours, leave a range of variances down to 0 equally likely: the largest
/// of them is the estimate.
///
/// `weight`: what a sample tells, of an independent one. Units: those of `step`.
/// Shapes: one value per sample; NaN is left out.
/// Source: Vardeman, Lee (2005), Likelihood-based statistical estimation from quantized data.
RoundedNoise EstimateRoundedNoise(const std::vector<Eigen::VectorXd>& stretches, double step,
                                  double weight, double confidence);

}  // namespace gauntlet::controller
