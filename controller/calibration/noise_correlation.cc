#include "controller/calibration/noise_correlation.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>

#include "controller/assert.h"

namespace gauntlet::controller {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

/// Deviations from the stretch's mean, 0 where a value is left out, and how many there are.
struct Stretch {
  VectorXd deviation;
  VectorXd present;  // 1, or 0 where a value is left out
  double samples = 0.0;
};

std::vector<Stretch> Centred(const std::vector<VectorXd>& stretches) {
  std::vector<Stretch> centred;
  for (const VectorXd& values : stretches) {
    Stretch stretch;
    stretch.present = values.unaryExpr([](double v) { return std::isnan(v) ? 0.0 : 1.0; });
    stretch.samples = stretch.present.sum();
    if (stretch.samples < 2.0) continue;
    stretch.deviation = values.unaryExpr([](double v) { return std::isnan(v) ? 0.0 : v; });
    const double mean = stretch.deviation.sum() / stretch.samples;
    stretch.deviation = (stretch.deviation.array() - mean) * stretch.present.array();
    centred.push_back(std::move(stretch));
  }
  return centred;
}

/// Mean product of deviations that are `lag` apart.
double ProductAt(Index lag, const std::vector<Stretch>& stretches) {
  double sum = 0.0;
  double pairs = 0.0;
  for (const Stretch& stretch : stretches) {
    const Index overlap = stretch.deviation.size() - lag;
    if (overlap < 1) continue;
    sum += stretch.deviation.head(overlap).dot(stretch.deviation.tail(overlap));
    pairs += stretch.present.head(overlap).dot(stretch.present.tail(overlap));
  }
  return pairs > 0.0 ? sum / pairs : 0.0;
}

/// Mean products at lags 1, 2, .. as long as they are beyond chance: at most to half of the longest
/// stretch, for the mean is taken from it. Of a small correlation that falls slowly one product
/// says little, so that the longer the lag, the more of its neighbours are judged with it. `taken`
/// is what the means have taken away of each product.
std::vector<double> ProductsBeyondChance(const std::vector<Stretch>& stretches, double variance,
                                         double samples, double taken) {
  constexpr double kSigmas = 2.0;
  constexpr std::size_t kNeighbours = 4;  // one for each so many lags
  std::size_t longest = 0;
  for (const Stretch& stretch : stretches) {
    longest = std::max(longest, static_cast<std::size_t>(stretch.deviation.size()));
  }
  std::vector<double> products;
  for (std::size_t kept = 0; kept < longest / 2; ++kept) {
    const std::size_t together = 1 + kept / kNeighbours;
    while (products.size() < kept + together) {
      products.push_back(ProductAt(static_cast<Index>(products.size() + 1), stretches));
    }
    const auto first = products.begin() + static_cast<std::ptrdiff_t>(kept);
    const double sum =
        std::accumulate(first, products.end(), taken * static_cast<double>(together));
    const double chance = variance * std::sqrt(static_cast<double>(together) / samples);
    if (std::abs(sum) <= kSigmas * chance) {
      products.resize(kept);
      break;
    }
  }
  return products;
}

}  // namespace

double ChannelNoise::MeanFactor(double sample_count) const {
  GAUNTLET_ASSERT(sample_count >= 0.0);
  double factor = 1.0;
  for (std::size_t i = 0; i < correlation.size(); ++i) {
    const double lag = static_cast<double>(i + 1);
    if (lag < sample_count) factor += 2.0 * (1.0 - lag / sample_count) * correlation[i];
  }
  return std::clamp(factor, 0.0, sample_count);
}

double ChannelNoise::VarianceFactor() const {
  double factor = 1.0;
  for (const double c : correlation) factor += 2.0 * c * c;
  return factor;
}

ChannelNoise DescribeNoise(const std::vector<VectorXd>& values, double rounding_variance) {
  GAUNTLET_ASSERT(rounding_variance >= 0.0);
  const std::vector<Stretch> stretches = Centred(values);
  ChannelNoise noise;
  double square_sum = 0.0;
  for (const Stretch& stretch : stretches) {
    noise.samples += stretch.samples;
    square_sum += stretch.deviation.squaredNorm();
  }
  const double own_means = static_cast<double>(stretches.size());
  if (noise.samples <= own_means) return noise;
  noise.variance = square_sum / (noise.samples - own_means);
  std::vector<double> products =
      ProductsBeyondChance(stretches, noise.variance, noise.samples, 0.0);
  // What the means take away depends on the correlation, which they make too small: a few rounds
  // settle both. Then it is known which products are beyond chance without it.
  constexpr int kRounds = 20;
  for (int round = 0; round < kRounds && !products.empty(); ++round) {
    double taken = 0.0;
    for (const Stretch& stretch : stretches) taken += noise.MeanFactor(stretch.samples);
    taken = std::min(taken, 0.5 * noise.samples);
    noise.variance = square_sum / (noise.samples - taken);
    const double of_product = noise.variance * taken / noise.samples;
    if (round == kRounds / 2) {
      products = ProductsBeyondChance(stretches, noise.variance, noise.samples, of_product);
    }
    const double sensor = std::max(noise.variance - rounding_variance, 0.01 * noise.variance);
    noise.correlation.clear();
    for (const double product : products) {
      noise.correlation.push_back(std::clamp((product + of_product) / sensor, -1.0, 1.0));
    }
  }
  noise.degrees_of_freedom = (noise.samples - own_means) / noise.VarianceFactor();
  return noise;
}

}  // namespace gauntlet::controller
