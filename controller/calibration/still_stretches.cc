#include "controller/calibration/still_stretches.h"

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "controller/assert.h"
#include "controller/calibration/robust_statistics.h"
#include "controller/calibration/samples_of_channels.h"

namespace gauntlet::controller {
namespace {

using Eigen::Index;

constexpr double kBlockS = 0.05;
constexpr double kSigmas = 5.0;
// Rounding to counts alone can hide all noise, so half a count is the least.
constexpr double kLeastNoise = 0.5;

/// The mean of values without those that are more than `limit` from their median.
double LevelOf(const Eigen::Ref<const Eigen::VectorXd>& values, double limit) {
  const double median = MedianOf({values.begin(), values.end()});
  double sum = 0.0;
  double samples = 0.0;
  for (const double value : values) {
    if (std::abs(value - median) > limit) continue;
    sum += value;
    ++samples;
  }
  return sum / samples;
}

/// Mean square of differences of samples `lag` apart, from `begin` on, without spikes.
double SquareOfDifferences(const Eigen::Ref<const Eigen::VectorXd>& z, Index lag) {
  std::vector<double> differences;
  for (Index k = lag; k < z.size(); ++k) differences.push_back(std::abs(z[k] - z[k - lag]));
  const double limit = kSigmas * std::max(DeviationFromDistances(differences), 2.0 * kLeastNoise);
  double sum = 0.0;
  double samples = 0.0;
  for (const double difference : differences) {
    if (difference > limit) continue;
    sum += difference * difference;
    ++samples;
  }
  return samples > 0.0 ? sum / samples : 0.0;
}

/// Noise of one channel, as far as stillness is judged by it.
struct Noise {
  double deviation = kLeastNoise;        // standard deviation of a sample
  double level_deviation = kLeastNoise;  // and of the mean of a block
};

/// Mean squares of differences at distances of 1, `lag`, 2 `lag` and 4 `lag` samples, over the
/// quarter of the windows whose levels move least.
std::array<double, 4> SquaresWhereQuiet(const Eigen::Ref<const Eigen::VectorXd>& z, Index block,
                                        Index lag) {
  constexpr Index kBlocksPerWindow = 10;
  const Index window = std::min<Index>(kBlocksPerWindow * block, z.size());
  std::vector<std::pair<double, Index>> moves;  // of the levels in a window; where it begins
  for (Index begin = 0; begin + window <= z.size(); begin += window) {
    double low = std::numeric_limits<double>::infinity();
    double high = -low;
    for (Index at = begin; at + block <= begin + window; at += block) {
      const double level = MedianOf({z.data() + at, z.data() + at + block});
      low = std::min(low, level);
      high = std::max(high, level);
    }
    moves.emplace_back(high - low, begin);
  }
  std::ranges::sort(moves);
  moves.resize((moves.size() + 3) / 4);
  std::array<double, 4> squares = {};
  for (const auto& [move, begin] : moves) {
    const auto part = z.segment(begin, window);
    const double share = 1.0 / static_cast<double>(moves.size());
    squares[0] += share * SquareOfDifferences(part, 1);
    squares[1] += share * SquareOfDifferences(part, lag);
    squares[2] += share * SquareOfDifferences(part, 2 * lag);
    squares[3] += share * SquareOfDifferences(part, 4 * lag);
  }
  return squares;
}

/// Noise with correlation c(l) has the mean square D(l) = 2 variance (1 - c(l)) at distance l. If
/// it falls as c = s p^n at n lags, with white noise on top (a share of 1 - s),
///
///     (D(4 lags) - D(2 lags)) / (D(2 lags) - D(lag)) = p (1 + p)
///     D(2 lags) - D(lag) = 2 variance s p (1 - p)
///
/// The square at distance 1 gives c(1), and c is taken to be linear between 1 and `lag`. Squares of
/// noise grow ever more slowly with the distance; where they do not, it is a motion, and the
/// shortest distance alone tells the noise.
Noise NoiseOf(const Eigen::Ref<const Eigen::VectorXd>& z, Index block, double rate_hz) {
  constexpr double kLagS = 0.008;
  constexpr double kChance = 0.05;  // a smaller rise is none
  constexpr double kMost = 0.97;
  const Index lag = std::max<Index>(1, std::lround(kLagS * rate_hz));
  if (z.size() < 8 * lag) return {};
  const auto [at_one, at_lag, at_two_lags, at_four_lags] = SquaresWhereQuiet(z, block, lag);
  constexpr double kSlack = 1.1;
  const bool moves = at_four_lags * at_lag > kSlack * at_two_lags * at_two_lags;
  double variance = 0.5 * (moves ? at_one : at_four_lags);
  double fall = 0.0;  // p
  double far = 0.0;   // s p
  if (!moves && at_four_lags - at_lag > kChance * at_lag) {
    const double rise = std::max(at_two_lags - at_lag, 1e-12);
    const double ratio = std::max(at_four_lags - at_two_lags, 0.0) / rise;
    fall = std::clamp(0.5 * (std::sqrt(1.0 + 4.0 * ratio) - 1.0), 0.05, kMost);
    const double correlated = 0.5 * rise / (1.0 - fall);  // of the variance, times p
    variance = 0.5 * at_lag + correlated;
    far = std::min(correlated / variance, kMost);
  }
  const double near = std::clamp(1.0 - 0.5 * at_one / std::max(variance, 1e-12), far, 1.0);
  double factor = 1.0;  // of the variance of a block's mean, in that of a sample over `block`
  for (Index l = 1; l < block; ++l) {
    const double part = static_cast<double>(l) / static_cast<double>(block);
    const double c =
        l < lag ? near + (far - near) * static_cast<double>(l - 1) /
                             static_cast<double>(std::max<Index>(lag - 1, 1))
                : far * std::pow(fall, static_cast<double>(l - lag) / static_cast<double>(lag));
    factor += 2.0 * (1.0 - part) * c;
  }
  Noise noise;
  noise.deviation = std::max(std::sqrt(variance), kLeastNoise);
  noise.level_deviation = noise.deviation * std::sqrt(factor / static_cast<double>(block));
  return noise;
}

}  // namespace

std::vector<StillStretch> FindStillStretches(std::span<const double> counts_of_channels,
                                             int channel_count, double rate_hz,
                                             double min_duration_s) {
  GAUNTLET_ASSERT(rate_hz > 0.0);
  const Eigen::Map<const Eigen::MatrixXd> counts =
      SamplesOfChannels(counts_of_channels, channel_count);
  const Index block = std::max<Index>(2, std::lround(kBlockS * rate_hz));
  std::vector<StillStretch> stretches;
  if (counts.rows() < 2 * block) return stretches;
  // Two levels of still noise differ by less than this; a part of the noise itself is allowed on
  // top, for what is slower than it was taken to be.
  std::vector<double> limit;  // of a sample's distance from its level
  Eigen::RowVectorXd allowed(counts.cols());
  for (Index i = 0; i < counts.cols(); ++i) {
    const Noise noise = NoiseOf(counts.col(i), block, rate_hz);
    limit.push_back(kSigmas * noise.deviation);
    allowed[i] = kSigmas * std::sqrt(2.0) * noise.level_deviation + 0.25 * noise.deviation;
  }
  const auto level_of = [&](Index first) {
    Eigen::RowVectorXd level(counts.cols());
    for (Index i = 0; i < counts.cols(); ++i) {
      level[i] = LevelOf(counts.col(i).segment(first, block), limit[static_cast<std::size_t>(i)]);
    }
    return level;
  };
  const auto is_near = [&](const Eigen::RowVectorXd& a, const Eigen::RowVectorXd& b) {
    return ((a - b).cwiseAbs().array() <= allowed.array()).all();
  };
  const auto keep = [&](Index begin, Index end) {
    // The block beside a motion may hold its slow beginning or end.
    if (begin > 0) begin += block;
    if (end + block <= counts.rows()) end -= block;
    if (static_cast<double>(end - begin) >= min_duration_s * rate_hz) {
      stretches.push_back({begin, end});
    }
  };
  Index begin = 0;
  Eigen::RowVectorXd first = level_of(0);
  Eigen::RowVectorXd last = first;
  Index at = block;
  for (; at + block <= counts.rows(); at += block) {
    const Eigen::RowVectorXd level = level_of(at);
    if (!is_near(level, first) || !is_near(level, last)) {
      keep(begin, at);
      begin = at;
      first = level;
    }
    last = level;
  }
  keep(begin, at);
  return stretches;
}

}  // namespace gauntlet::controller
