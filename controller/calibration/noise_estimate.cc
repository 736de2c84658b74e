#include "controller/calibration/noise_estimate.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "controller/assert.h"
#include "controller/calibration/noise_correlation.h"
#include "controller/calibration/robust_statistics.h"
#include "controller/calibration/rounded_noise.h"
#include "controller/calibration/samples_of_channels.h"
#include "controller/number.h"
#include "controller/settings.h"

namespace gauntlet::controller {
namespace {

using Eigen::Index;

/// One channel in each stretch, with NaN in place of spikes.
struct StillChannel {
  std::vector<Eigen::VectorXd> stretches;
  Index spikes = 0;
};

/// The scale is the median distance from the medians of the stretches, which a few spikes do not
/// move; rounding can make it 0, so half a step is the least.
StillChannel WithoutSpikes(const Eigen::Ref<const Eigen::VectorXd>& counts,
                           const std::vector<StillStretch>& stretches, double resolution) {
  constexpr double kSigmas = 5.0;
  StillChannel channel;
  std::vector<double> distances;
  for (const StillStretch& stretch : stretches) {
    if (stretch.end <= stretch.begin) continue;
    Eigen::VectorXd& values =
        channel.stretches.emplace_back(counts.segment(stretch.begin, stretch.end - stretch.begin));
    values.array() -= MedianOf({values.begin(), values.end()});
    for (const double value : values) distances.push_back(std::abs(value));
  }
  const double limit = kSigmas * std::max(DeviationFromDistances(distances), 0.5 * resolution);
  for (Eigen::VectorXd& values : channel.stretches) {
    for (double& value : values) {
      if (limit == 0.0 || std::abs(value) <= limit) continue;
      value = kNaN;
      ++channel.spikes;
    }
  }
  return channel;
}

/// All stretches, one after another, around their means; 0 in place of spikes.
Eigen::VectorXd Deviations(const StillChannel& channel) {
  std::vector<double> deviations;
  for (const Eigen::VectorXd& values : channel.stretches) {
    double sum = 0.0;
    double samples = 0.0;
    for (const double value : values) {
      if (std::isnan(value)) continue;
      sum += value;
      ++samples;
    }
    for (const double value : values) {
      deviations.push_back(std::isnan(value) ? 0.0 : value - sum / samples);
    }
  }
  return Eigen::Map<const Eigen::VectorXd>(deviations.data(), std::ssize(deviations));
}

/// Variance and interval of channel `i`; what is known of its noise without rounding.
void SetVariance(std::size_t i, const StillChannel& channel, const ChannelNoise& noise,
                 const NoiseEstimateOptions& options, NoiseEstimate& estimate) {
  constexpr double kSureFrom = 0.5;  // steps^2: a deviation of 0.7 steps
  const double step2 = options.resolution_counts * options.resolution_counts;
  estimate.variance[i] = std::max(noise.variance - step2 / 12.0, 0.0);
  estimate.correlation[i] = noise.correlation.empty() ? 0.0 : noise.correlation.front();
  if (estimate.variance[i] < kSureFrom * step2) {
    const RoundedNoise rounded =
        EstimateRoundedNoise(channel.stretches, options.resolution_counts,
                             1.0 / noise.VarianceFactor(), options.confidence);
    estimate.rounded[i] = true;
    estimate.variance[i] = rounded.variance;
    estimate.variance_low[i] = rounded.variance_low;
    estimate.variance_high[i] = rounded.variance_high;
    return;
  }
  const double tail = 0.5 * (1.0 - options.confidence);
  const double freedom = std::max(noise.degrees_of_freedom, 1.0);
  const auto at = [&](double probability) {
    return noise.variance / ChiSquaredQuantileRatio(probability, freedom) - step2 / 12.0;
  };
  estimate.variance_low[i] = std::max(at(1.0 - tail), 0.0);
  estimate.variance_high[i] = at(tail);
}

}  // namespace

double NormalQuantile(double probability) {
  GAUNTLET_ASSERT(0.0 < probability && probability < 1.0);
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
  GAUNTLET_ASSERT(degrees_of_freedom > 0.0);
  const double spread = 2.0 / (9.0 * degrees_of_freedom);
  const double root = 1.0 - spread + NormalQuantile(probability) * std::sqrt(spread);
  return root > 0.0 ? root * root * root : 0.0;
}

NoiseEstimate EstimateNoise(std::span<const double> counts_of_channels, int channel_count,
                            const std::vector<StillStretch>& stretches,
                            const NoiseEstimateOptions& options) {
  GAUNTLET_ASSERT(0.0 < options.confidence && options.confidence < 1.0);
  GAUNTLET_ASSERT(options.resolution_counts >= 0.0);
  const Eigen::Map<const Eigen::MatrixXd> counts =
      SamplesOfChannels(counts_of_channels, channel_count);
  if (!counts.allFinite()) throw SettingError("recording", "has values that are not finite");
  NoiseEstimate estimate;
  for (const StillStretch& stretch : stretches) {
    GAUNTLET_ASSERT(0 <= stretch.begin && stretch.end <= counts.rows());
    estimate.degrees_of_freedom +=
        static_cast<double>(std::max<Index>(stretch.end - stretch.begin - 1, 0));
  }
  if (estimate.degrees_of_freedom < 1.0) {
    throw SettingError("recording", "has no stretch of two samples in which the hand holds still");
  }
  const Index n = counts.cols();
  const auto channels = static_cast<std::size_t>(n);
  for (std::vector<double>* values : {&estimate.variance, &estimate.variance_low,
                                      &estimate.variance_high, &estimate.correlation}) {
    values->resize(channels);
  }
  estimate.rounded.assign(channels, false);
  const double rounding = options.resolution_counts * options.resolution_counts / 12.0;
  Eigen::MatrixXd deviations;
  Eigen::ArrayXd freedom(n);
  for (Index i = 0; i < n; ++i) {
    const StillChannel channel = WithoutSpikes(counts.col(i), stretches, options.resolution_counts);
    const ChannelNoise noise = DescribeNoise(channel.stretches, rounding);
    SetVariance(static_cast<std::size_t>(i), channel, noise, options, estimate);
    estimate.spikes.push_back(channel.spikes);
    freedom[i] = std::max(noise.degrees_of_freedom, 1.0);
    // Scaled so that the product of two channels is their covariance.
    Eigen::VectorXd own = Deviations(channel);
    if (noise.variance > 0.0) own /= own.norm() / std::sqrt(noise.variance);
    if (deviations.size() == 0) deviations.resize(own.size(), n);
    deviations.col(i) = own;
  }
  const auto of_channels = [n](const std::vector<double>& values) {
    return Eigen::Map<const Eigen::VectorXd>(values.data(), n);
  };
  const auto variance = of_channels(estimate.variance);
  Eigen::MatrixXd covariance = deviations.transpose() * deviations;
  covariance.diagonal() = variance;

  const double sigmas = NormalQuantile(0.5 + 0.5 * options.confidence);
  const Eigen::MatrixXd scale = freedom.sqrt().matrix() * freedom.sqrt().matrix().transpose();
  const Eigen::MatrixXd spread =
      sigmas *
      ((variance * variance.transpose() + covariance.cwiseAbs2()).cwiseQuotient(scale)).cwiseSqrt();
  Eigen::MatrixXd low = covariance - spread;
  Eigen::MatrixXd high = covariance + spread;
  low.diagonal() = of_channels(estimate.variance_low);
  high.diagonal() = of_channels(estimate.variance_high);
  const auto row_by_row = [](const Eigen::MatrixXd& values) {
    const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> rows = values;
    return std::vector<double>(rows.data(), rows.data() + rows.size());
  };
  estimate.covariance = row_by_row(covariance);
  estimate.covariance_low = row_by_row(low);
  estimate.covariance_high = row_by_row(high);
  return estimate;
}

}  // namespace gauntlet::controller
