#include "controller/calibration/noise_estimate.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "controller/settings.h"

namespace gauntlet::controller {
namespace {

using Eigen::Index;

/// Standard deviation of the noise per channel, from the median of |z(k) - z(k-1)|.
Eigen::RowVectorXd NoiseFromDifferences(const Eigen::MatrixXd& counts) {
  Eigen::RowVectorXd noise(counts.cols());
  std::vector<double> steps(counts.rows() - 1);
  for (Index i = 0; i < counts.cols(); ++i) {
    for (Index k = 1; k < counts.rows(); ++k) {
      steps[k - 1] = std::abs(counts(k, i) - counts(k - 1, i));
    }
    const auto middle = steps.begin() + steps.size() / 2;
    std::nth_element(steps.begin(), middle, steps.end());
    // 0.6745 is the normal quantile at 3/4; a difference has twice the variance. Rounding to counts
    // alone can make the median 0, so half a count is the least.
    noise[i] = std::max(*middle / (0.6745 * std::numbers::sqrt2), 0.5);
  }
  return noise;
}

struct Sums {
  Eigen::MatrixXd products;  // of deviations from the stretch's mean
  Eigen::VectorXd lagged;    // the same between neighbouring samples, per channel
  double degrees_of_freedom = 0.0;
};

Sums SumUp(const Eigen::MatrixXd& counts, const std::vector<StillStretch>& stretches) {
  const Index n = counts.cols();
  Sums sums{Eigen::MatrixXd::Zero(n, n), Eigen::VectorXd::Zero(n)};
  for (const StillStretch& stretch : stretches) {
    const Index length = stretch.end - stretch.begin;
    if (length < 2) continue;
    const Eigen::MatrixXd block = counts.middleRows(stretch.begin, length);
    const Eigen::MatrixXd deviation = block.rowwise() - block.colwise().mean();
    sums.products += deviation.transpose() * deviation;
    sums.lagged += deviation.topRows(length - 1)
                       .cwiseProduct(deviation.bottomRows(length - 1))
                       .colwise()
                       .sum()
                       .transpose();
    sums.degrees_of_freedom += length - 1;
  }
  return sums;
}

}  // namespace

double NormalQuantile(double probability) {
  // Newton on Phi(x) = erfc(-x / sqrt 2) / 2 from a rough start; converges from everywhere inside
  // because steps are bounded.
  double x = 0.0;
  for (int i = 0; i < 100; ++i) {
    const double error = 0.5 * std::erfc(-x / std::numbers::sqrt2) - probability;
    const double density = std::exp(-0.5 * x * x) / std::sqrt(2.0 * std::numbers::pi);
    const double step = std::clamp(error / density, -1.0, 1.0);
    x -= step;
    if (std::abs(step) < 1e-15) break;
  }
  return x;
}

double ChiSquaredQuantileRatio(double probability, double degrees_of_freedom) {
  const double spread = 2.0 / (9.0 * degrees_of_freedom);
  const double root = 1.0 - spread + NormalQuantile(probability) * std::sqrt(spread);
  return root > 0.0 ? root * root * root : 0.0;
}

std::vector<StillStretch> FindStillStretches(const Eigen::MatrixXd& counts, double rate_hz,
                                             double min_duration_s) {
  constexpr double kBlockS = 0.05;
  constexpr double kSigmas = 5.0;
  const Index block = std::max<Index>(2, std::lround(kBlockS * rate_hz));
  std::vector<StillStretch> stretches;
  if (counts.rows() < 2 * block) return stretches;
  // Two means of still noise differ by less than this; what is slower than white adds to it, so the
  // noise itself is allowed on top.
  const Eigen::RowVectorXd noise = NoiseFromDifferences(counts);
  const Eigen::RowVectorXd allowed = noise * (kSigmas * std::sqrt(2.0 / block) + 0.25);
  const auto mean_of = [&](Index first) -> Eigen::RowVectorXd {
    return counts.middleRows(first, block).colwise().mean();
  };
  const auto is_near = [&](const Eigen::RowVectorXd& a, const Eigen::RowVectorXd& b) {
    return ((a - b).cwiseAbs().array() <= allowed.array()).all();
  };
  const auto keep = [&](Index begin, Index end) {
    // The block beside a motion may hold its slow beginning or end.
    if (begin > 0) begin += block;
    if (end + block <= counts.rows()) end -= block;
    if (end - begin >= min_duration_s * rate_hz) {
      stretches.push_back({begin, end});
    }
  };
  Index begin = 0;
  Eigen::RowVectorXd first = mean_of(0);
  Eigen::RowVectorXd last = first;
  Index at = block;
  for (; at + block <= counts.rows(); at += block) {
    const Eigen::RowVectorXd mean = mean_of(at);
    if (!is_near(mean, first) || !is_near(mean, last)) {
      keep(begin, at);
      begin = at;
      first = mean;
    }
    last = mean;
  }
  keep(begin, at);
  return stretches;
}

NoiseEstimate EstimateNoise(const Eigen::MatrixXd& counts,
                            const std::vector<StillStretch>& stretches,
                            const NoiseEstimateOptions& options) {
  if (!counts.allFinite()) throw SettingError("recording", "has values that are not finite");
  const Sums sums = SumUp(counts, stretches);
  if (sums.degrees_of_freedom < 1.0) {
    throw SettingError("recording", "has no stretch of two samples in which the hand holds still");
  }
  const Index n = counts.cols();
  NoiseEstimate estimate;
  estimate.degrees_of_freedom = sums.degrees_of_freedom;
  estimate.correlation = sums.lagged.cwiseQuotient(
      sums.products.diagonal().cwiseMax(std::numeric_limits<double>::min()));
  estimate.covariance = sums.products / sums.degrees_of_freedom;
  const double rounding = options.resolution_counts * options.resolution_counts / 12.0;
  estimate.covariance.diagonal().array() =
      (estimate.covariance.diagonal().array() - rounding).max(0.0);
  estimate.variance = estimate.covariance.diagonal();

  const Eigen::ArrayXd squared = estimate.correlation.array().square();
  const Eigen::ArrayXd freedom =
      (sums.degrees_of_freedom * (1.0 - squared) / (1.0 + squared)).max(1.0);
  const double tail = 0.5 * (1.0 - options.confidence);
  const double sigmas = NormalQuantile(1.0 - tail);
  estimate.variance_low.resize(n);
  estimate.variance_high.resize(n);
  for (Index i = 0; i < n; ++i) {
    estimate.variance_low[i] =
        estimate.variance[i] / ChiSquaredQuantileRatio(1.0 - tail, freedom[i]);
    estimate.variance_high[i] = estimate.variance[i] / ChiSquaredQuantileRatio(tail, freedom[i]);
  }
  const Eigen::MatrixXd scale = freedom.sqrt().matrix() * freedom.sqrt().matrix().transpose();
  const Eigen::MatrixXd spread =
      sigmas *
      ((estimate.variance * estimate.variance.transpose() + estimate.covariance.cwiseAbs2())
           .cwiseQuotient(scale))
          .cwiseSqrt();
  estimate.covariance_low = estimate.covariance - spread;
  estimate.covariance_high = estimate.covariance + spread;
  estimate.covariance_low.diagonal() = estimate.variance_low;
  estimate.covariance_high.diagonal() = estimate.variance_high;
  return estimate;
}

}  // namespace gauntlet::controller
