#include "sim/score/error_split.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>

#include "sim/score/delay.h"
#include "sim/score/jitter.h"

namespace gauntlet::sim {
namespace {

constexpr double kAfterLimit_s = 0.25;
constexpr double kShortestLimit_s = 0.02;
constexpr double kLargestDelay_s = 0.5;
constexpr double kLeastFit_s = 0.5;
constexpr double kSearchRate_hz = 100.0;  // hands move below 10 Hz

using Ticks = std::vector<std::uint8_t>;  // 1 where a tick counts

/// The signals of one joint.
struct Joint {
  double rate_hz;
  std::span<const double> reference;
  std::span<const double> hand;
  std::span<const double> noise_free_hand;
  Ticks free;  // 0 while one of its motors is at its limit, and a while after
};

/// hand(t) ~ constant + gain * reference(t - delay).
struct Following {
  double delay_ticks = 0.0;
  double gain = 1.0;
  double constant_rad = 0.0;
};

std::span<const double> Column(const Signal& signal, int column, Eigen::Index rows) {
  return {signal.col(column).data(), static_cast<std::size_t>(rows)};
}

Ticks FreeTicks(const ScoreInput& input, int joint, Eigen::Index rows) {
  const auto in_ticks = [&](double time_s) {
    return static_cast<Eigen::Index>(std::lround(time_s * input.rate_hz));
  };
  const Eigen::Index shortest =
      std::max<Eigen::Index>(1, in_ticks(std::max(kShortestLimit_s, 0.001 * input.frame_ms)));
  Ticks free(static_cast<std::size_t>(rows), 1);
  for (const int motor : input.motors_of_joint[static_cast<std::size_t>(joint)]) {
    const int* at_limit = input.noise_free_motor_at_limit->col(motor).data();
    for (Eigen::Index begin = 0; begin < rows; ++begin) {
      if (at_limit[begin] == 0) continue;
      Eigen::Index end = begin;
      while (end < rows && at_limit[end] != 0) ++end;
      if (end - begin >= shortest) {
        const Eigen::Index until = std::min(rows, end + in_ticks(kAfterLimit_s));
        std::fill(free.begin() + begin, free.begin() + until, 0);
      }
      begin = end;
    }
  }
  return free;
}

/// The reference of `delay` ticks ago, linear between ticks; its first and last value go on.
double Delayed(std::span<const double> reference, std::ptrdiff_t tick, double delay_ticks) {
  const double last = static_cast<double>(reference.size() - 1);
  const double at = std::clamp(static_cast<double>(tick) - delay_ticks, 0.0, last);
  const auto before = static_cast<std::size_t>(at);
  const double fraction = at - static_cast<double>(before);
  if (fraction == 0.0) return reference[before];
  return reference[before] + fraction * (reference[before + 1] - reference[before]);
}

/// Means of `step` ticks each: at a lower rate, without what could fold into the motion.
Eigen::VectorXd Means(std::span<const double> values, int step) {
  const auto count = static_cast<Eigen::Index>(values.size()) / step;
  const Eigen::Map<const Eigen::MatrixXd> blocks(values.data(), step, count);
  return blocks.colwise().mean();
}

/// 1 for every `step` ticks that all count.
Eigen::VectorXd WholeBlocks(const Ticks& ticks, int step) {
  const auto count = static_cast<Eigen::Index>(ticks.size()) / step;
  const Eigen::Map<const Eigen::Matrix<std::uint8_t, Eigen::Dynamic, Eigen::Dynamic>> blocks(
      ticks.data(), step, count);
  return blocks.colwise().minCoeff().transpose().cast<double>();
}

/// The lag in ticks at which Pearson's correlation over the ticks that count is largest; 0 where
/// there is no such lag. The same ticks of the hand count at every lag.
double FindDelay(const Joint& joint, const Ticks& counting, Fourier& fourier) {
  const int step = std::max(1, static_cast<int>(std::lround(joint.rate_hz / kSearchRate_hz)));
  const double rate_hz = joint.rate_hz / step;
  Eigen::VectorXd reference = Means(joint.reference, step);
  Eigen::VectorXd hand = Means(joint.noise_free_hand, step);
  const Eigen::VectorXd counts = WholeBlocks(counting, step);
  const auto size = static_cast<int>(reference.size());
  if (size < 8) return 0.0;
  reference.array() -= reference.mean();
  hand.array() -= hand.mean();
  const double half_period =
      0.5 * DominantPeriod({reference.data(), static_cast<std::size_t>(size)}, fourier);
  const int bound = std::min(
      {size / 4, static_cast<int>(kLargestDelay_s * rate_hz), static_cast<int>(half_period)});
  const int compared = size - 2 * bound;
  const auto weights = counts.segment(bound, compared);
  const double count = weights.sum();
  if (bound < 1 || count < kLeastFit_s * rate_hz) return 0.0;

  const Eigen::VectorXd hands = hand.segment(bound, compared).cwiseProduct(weights);
  const double hand_variation = hands.squaredNorm() - hands.sum() * hands.sum() / count;
  const double still = kStillRms_rad * kStillRms_rad * count;
  if (!(hand_variation > still)) return 0.0;
  const Eigen::VectorXd squares = reference.array().square();
  std::vector<double> correlations;
  for (int lag = -bound; lag <= bound; ++lag) {
    const auto past = reference.segment(bound - lag, compared);
    const double sum = past.dot(weights);
    const double variation =
        squares.segment(bound - lag, compared).dot(weights) - sum * sum / count;
    const double covariation = past.dot(hands) - sum * hands.sum() / count;
    correlations.push_back(variation > still ? covariation / std::sqrt(variation * hand_variation)
                                             : 0.0);
  }
  const auto peak = std::ranges::max_element(correlations);
  const bool at_the_bound = peak == correlations.begin() || peak + 1 == correlations.end();
  if (at_the_bound || !(*peak > 0.0)) return 0.0;
  const double lag = static_cast<double>(peak - correlations.begin()) - bound;
  return step * (lag + ParabolaPeak(peak[-1], peak[0], peak[1]));
}

/// Gain and constant by least squares, where the reference of `delay` ago is known.
Following FitAt(double delay_ticks, const Joint& joint, const Ticks& counting) {
  const auto ticks = std::ssize(joint.hand);
  const auto begin = static_cast<std::ptrdiff_t>(std::ceil(std::max(0.0, delay_ticks)));
  const auto end = ticks + static_cast<std::ptrdiff_t>(std::floor(std::min(0.0, delay_ticks)));
  double x_sum = 0.0;
  double y_sum = 0.0;
  double xx_sum = 0.0;
  double xy_sum = 0.0;
  double count = 0.0;
  const double x_shift = joint.reference.front();  // against loss of digits
  const double y_shift = joint.noise_free_hand.front();
  for (std::ptrdiff_t n = begin; n < end; ++n) {
    if (counting[static_cast<std::size_t>(n)] == 0) continue;
    const double x = Delayed(joint.reference, n, delay_ticks) - x_shift;
    const double y = joint.noise_free_hand[static_cast<std::size_t>(n)] - y_shift;
    x_sum += x;
    y_sum += y;
    xx_sum += x * x;
    xy_sum += x * y;
    count += 1.0;
  }
  Following following{.delay_ticks = delay_ticks};
  if (count == 0.0) return following;
  const double variation = xx_sum - x_sum * x_sum / count;
  if (variation > kStillRms_rad * kStillRms_rad * count) {
    following.gain = (xy_sum - x_sum * y_sum / count) / variation;
  }
  following.constant_rad = y_sum / count + y_shift - following.gain * (x_sum / count + x_shift);
  return following;
}

Following Fit(const Joint& joint, Fourier& fourier) {
  const auto free = std::ranges::count(joint.free, 1);
  const bool enough = static_cast<double>(free) >= kLeastFit_s * joint.rate_hz;
  const Ticks all = enough ? Ticks() : Ticks(joint.free.size(), 1);
  const Ticks& counting = enough ? joint.free : all;
  return FitAt(FindDelay(joint, counting, fourier), joint, counting);
}

/// `rest_above` is what is left of the noise-free hand, above the edge, from `first` on.
ErrorSplit Split(const Joint& joint, const Following& fit, std::span<const double> rest_above,
                 std::ptrdiff_t first) {
  const auto ticks = std::ssize(joint.hand);
  double mean_delayed = 0.0;
  for (std::ptrdiff_t n = 0; n < ticks; ++n) {
    mean_delayed += Delayed(joint.reference, n, fit.delay_ticks);
  }
  mean_delayed /= static_cast<double>(ticks);
  const double constant = fit.constant_rad + (fit.gain - 1.0) * mean_delayed;

  ErrorSplit sums;
  for (std::ptrdiff_t n = 0; n < ticks; ++n) {
    const auto i = static_cast<std::size_t>(n);
    const double error = joint.hand[i] - joint.reference[i];
    const double delayed = Delayed(joint.reference, n, fit.delay_ticks);
    const double left = joint.noise_free_hand[i] - fit.constant_rad - fit.gain * delayed;
    sums.Of(ErrorCause::kDelay) += (delayed - joint.reference[i]) * error;
    sums.Of(ErrorCause::kConstant) += constant * error;
    sums.Of(ErrorCause::kGain) += (fit.gain - 1.0) * (delayed - mean_delayed) * error;
    sums.Of(ErrorCause::kNoise) += (joint.hand[i] - joint.noise_free_hand[i]) * error;
    if (joint.free[i] == 0) {
      sums.Of(ErrorCause::kLimit) += left * error;
      continue;
    }
    const std::ptrdiff_t row = n - first;
    const double above =
        row >= 0 && row < std::ssize(rest_above) ? rest_above[static_cast<std::size_t>(row)] : 0.0;
    sums.Of(ErrorCause::kFrames) += above * error;
    sums.Of(ErrorCause::kRest) += (left - above) * error;
  }
  for (double& sum : sums.mean_squares) sum /= static_cast<double>(ticks);
  return sums;
}

}  // namespace

std::vector<ErrorSplit> SplitErrors(const ScoreInput& input, Fourier& fourier) {
  const Eigen::Index rows = input.hand_angle_rad->rows();
  if (rows == 0 || input.noise_free_hand_angle_rad == nullptr ||
      input.noise_free_motor_at_limit == nullptr || input.motors_of_joint.empty()) {
    return {};
  }
  const int joints = static_cast<int>(input.hand_angle_rad->cols());
  const auto signals_of = [&](int joint) {
    return Joint{.rate_hz = input.rate_hz,
                 .reference = Column(*input.reference_angle_rad, joint, rows),
                 .hand = Column(*input.hand_angle_rad, joint, rows),
                 .noise_free_hand = Column(*input.noise_free_hand_angle_rad, joint, rows),
                 .free = FreeTicks(input, joint, rows)};
  };
  std::vector<Following> fits;
  Signal left(rows, joints);
  for (int j = 0; j < joints; ++j) {
    const Joint joint = signals_of(j);
    const Following fit = fits.emplace_back(Fit(joint, fourier));
    for (Eigen::Index n = 0; n < rows; ++n) {
      left(n, j) = joint.noise_free_hand[static_cast<std::size_t>(n)] - fit.constant_rad -
                   fit.gain * Delayed(joint.reference, n, fit.delay_ticks);
    }
    TrimSignals();
  }
  const FilteredSignal above = Trembling(left, input.rate_hz, input.jitter_above_hz, fourier);
  std::vector<ErrorSplit> splits;
  for (int j = 0; j < joints; ++j) {
    splits.push_back(Split(signals_of(j), fits[static_cast<std::size_t>(j)],
                           Column(above.values, j, above.values.rows()), above.first_sample));
    TrimSignals();
  }
  return splits;
}

}  // namespace gauntlet::sim
