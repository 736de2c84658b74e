#include "sim/score/error_split.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <vector>

#include "sim/score/delay.h"
#include "sim/score/jitter.h"

namespace gauntlet::sim {
namespace {

constexpr double kAfterLimit_s = 0.25;
constexpr double kShortestLimit_s = 0.02;
constexpr double kLargestDelay_s = 0.5;
constexpr double kLeastFit_s = 0.5;
constexpr double kRounding_ticks = 1e-6;  // a delay is whole ticks up to it
constexpr double kSearchRate_hz = 100.0;  // hands move below 10 Hz

using Eigen::Index;
using Eigen::VectorXd;
using Column = Eigen::Map<const VectorXd>;

/// The signals of one joint.
struct Joint {
  double rate_hz;
  Column reference;
  Column hand;
  Column noise_free_hand;
  VectorXd counted;    // 1 in ticks that count, else 0
  VectorXd trembling;  // 1 where only such ticks have a share in the high pass
  VectorXd free;  // as counted, but 0 while one of its motors is at its limit, and a while after
};

/// hand(t) ~ constant + gain * reference(t - delay).
struct Following {
  double delay_ticks = 0.0;
  double gain = 1.0;
  double constant_rad = 0.0;
};

/// 1 within the ranges, else 0.
VectorXd Weights(const CountedTicks& counted, Index rows) {
  VectorXd weights = VectorXd::Zero(rows);
  for (const TickRange& range : counted) {
    weights.segment(range.begin, range.end - range.begin).setOnes();
  }
  return weights;
}

VectorXd FreeTicks(const ScoreInput& input, int joint, VectorXd free) {
  const Index rows = free.size();
  const auto in_ticks = [&](double time_s) {
    return static_cast<Index>(std::lround(time_s * input.rate_hz));
  };
  const double shortest_s = std::max(kShortestLimit_s, 0.001 * input.frame_ms);
  for (const int motor : input.motors_of_joint[static_cast<std::size_t>(joint)]) {
    const auto at_limit = input.noise_free_motor_at_limit->col(motor);
    Index begin = 0;
    for (Index n = 0; n <= rows; ++n) {
      if (n < rows && at_limit[n] != 0) continue;
      if (n > begin && n - begin >= in_ticks(shortest_s)) {
        const Index end = std::min(rows, n + in_ticks(kAfterLimit_s));
        free.segment(begin, end - begin).setZero();
      }
      begin = n + 1;
    }
  }
  return free;
}

/// The reference of `delay_ticks` ago, linear between ticks; before the first and beyond the last
/// it goes on as it is there.
VectorXd Delayed(const Column& reference, double delay_ticks) {
  const Index ticks = reference.size();
  const double whole = std::floor(-delay_ticks);
  const double fraction = -delay_ticks - whole;
  const auto shift = static_cast<Index>(whole);
  const Index begin = std::clamp<Index>(-shift, 0, ticks);
  const Index end = std::clamp<Index>(ticks - 1 - shift, begin, ticks);
  VectorXd delayed(ticks);
  delayed.head(begin).setConstant(reference[0]);
  delayed.segment(begin, end - begin) =
      (1.0 - fraction) * reference.segment(begin + shift, end - begin) +
      fraction * reference.segment(begin + shift + 1, end - begin);
  delayed.tail(ticks - end).setConstant(reference[ticks - 1]);
  return delayed;
}

/// Means of `step` ticks each: at a lower rate, without what could fold into the motion.
VectorXd Means(const Eigen::Ref<const VectorXd>& values, int step) {
  const Eigen::Map<const Eigen::MatrixXd> blocks(values.data(), step, values.size() / step);
  return blocks.colwise().mean();
}

/// The lag in ticks at which Pearson's correlation over the ticks that count is largest; 0 where
/// there is no such lag, or what correlates is hardly the wearer's motion. The same ticks of the
/// hand count at every lag.
double FindDelay(const Joint& joint, const VectorXd& counting, Fourier& fourier) {
  const int step = std::max(1, static_cast<int>(std::lround(joint.rate_hz / kSearchRate_hz)));
  const double rate_hz = joint.rate_hz / step;
  VectorXd reference = Means(joint.reference, step);
  VectorXd hand = Means(joint.noise_free_hand, step);
  const Index size = reference.size();
  if (size < 8) return 0.0;
  reference.array() -= reference.mean();
  hand.array() -= hand.mean();
  const double half_period =
      0.5 * DominantPeriod({reference.data(), static_cast<std::size_t>(size)}, fourier);
  const auto bound = static_cast<Index>(
      std::min({0.25 * static_cast<double>(size), kLargestDelay_s * rate_hz, half_period}));
  const Index compared = size - 2 * bound;
  // A block counts if all its ticks do.
  const VectorXd weights = Means(counting, step).segment(bound, compared).array().floor();
  const double count = weights.sum();
  if (bound < 1 || count < kLeastFit_s * rate_hz) return 0.0;

  const VectorXd hands = hand.segment(bound, compared).cwiseProduct(weights);
  const double hand_variation = hands.squaredNorm() - hands.sum() * hands.sum() / count;
  const double still = kStillRms_rad * kStillRms_rad * count;
  if (!(hand_variation > still)) return 0.0;
  const VectorXd squares = reference.array().square();
  std::vector<double> correlations;
  for (Index lag = -bound; lag <= bound; ++lag) {
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
  if (at_the_bound || !(*peak >= kLeastDelayCorrelation)) return 0.0;
  const auto lag = static_cast<double>(peak - correlations.begin() - bound);
  return step * (lag + ParabolaPeak(peak[-1], peak[0], peak[1]));
}

/// Gain and constant by least squares, where the reference of `delay_ticks` ago is known.
Following FitAt(double delay_ticks, const Joint& joint, const VectorXd& counting) {
  const Index ticks = joint.hand.size();
  const auto begin = static_cast<Index>(std::ceil(std::max(0.0, delay_ticks - kRounding_ticks)));
  const Index end =
      ticks + static_cast<Index>(std::floor(std::min(0.0, delay_ticks + kRounding_ticks)));
  Following following{.delay_ticks = delay_ticks};
  if (end <= begin) return following;
  const auto weights = counting.segment(begin, end - begin);
  const double count = weights.sum();
  if (count == 0.0) return following;
  VectorXd x = Delayed(joint.reference, delay_ticks).segment(begin, end - begin);
  VectorXd y = joint.noise_free_hand.segment(begin, end - begin);
  const double x_mean = x.dot(weights) / count;
  const double y_mean = y.dot(weights) / count;
  x = (x.array() - x_mean) * weights.array();
  y.array() -= y_mean;
  const double variation = x.squaredNorm();
  if (variation > kStillRms_rad * kStillRms_rad * count) following.gain = x.dot(y) / variation;
  following.constant_rad = y_mean - following.gain * x_mean;
  return following;
}

Following Fit(const Joint& joint, Fourier& fourier) {
  const bool enough = joint.free.sum() >= kLeastFit_s * joint.rate_hz;
  const VectorXd& counting = enough ? joint.free : joint.counted;
  return FitAt(FindDelay(joint, counting, fourier), joint, counting);
}

/// What the fit leaves of the noise-free hand.
VectorXd Left(const Joint& joint, const Following& fit) {
  return joint.noise_free_hand.array() - fit.constant_rad -
         fit.gain * Delayed(joint.reference, fit.delay_ticks).array();
}

/// `above` is what the fit leaves, above the edge, of the ticks from `first` on.
ErrorSplit Split(const Joint& joint, const Following& fit, const Column& above, Index first) {
  const VectorXd error = (joint.hand - joint.reference).cwiseProduct(joint.counted);
  const VectorXd delayed = Delayed(joint.reference, fit.delay_ticks);
  const VectorXd left_error = Left(joint, fit).cwiseProduct(error);
  const double mean = delayed.mean();
  const double free_left = left_error.dot(joint.free);
  const double free_above = above.dot(
      error.cwiseProduct(joint.free.cwiseProduct(joint.trembling)).segment(first, above.size()));
  ErrorSplit split;
  split.Of(ErrorCause::kDelay) = (delayed - joint.reference).dot(error);
  split.Of(ErrorCause::kConstant) = (fit.constant_rad + (fit.gain - 1.0) * mean) * error.sum();
  split.Of(ErrorCause::kGain) = (fit.gain - 1.0) * (delayed.array() - mean).matrix().dot(error);
  split.Of(ErrorCause::kLimit) = left_error.dot((1.0 - joint.free.array()).matrix());
  split.Of(ErrorCause::kFrames) = free_above;
  split.Of(ErrorCause::kNoise) = (joint.hand - joint.noise_free_hand).dot(error);
  split.Of(ErrorCause::kRest) = free_left - free_above;
  for (double& part : split.mean_squares) part /= joint.counted.sum();
  return split;
}

}  // namespace

std::vector<ErrorSplit> SplitErrors(const ScoreInput& input, Fourier& fourier) {
  const Index rows = input.hand_angle_rad->rows();
  if (rows == 0 || input.noise_free_hand_angle_rad == nullptr ||
      input.noise_free_motor_at_limit == nullptr || input.motors_of_joint.empty()) {
    return {};
  }
  const int joints = static_cast<int>(input.hand_angle_rad->cols());
  const auto signals_of = [&](int joint) {
    const CountedTicks counted = input.counted != nullptr
                                     ? input.counted->joints[static_cast<std::size_t>(joint)]
                                     : CountedTicks{{0, static_cast<int>(rows)}};
    const auto column = [&](const Signal& signal) {
      return Column(signal.col(joint).data(), rows);
    };
    return Joint{
        .rate_hz = input.rate_hz,
        .reference = column(*input.reference_angle_rad),
        .hand = column(*input.hand_angle_rad),
        .noise_free_hand = column(*input.noise_free_hand_angle_rad),
        .counted = Weights(counted, rows),
        .trembling = Weights(TremblingWithin(counted, input.rate_hz, input.jitter_above_hz), rows),
        .free = FreeTicks(input, joint, Weights(counted, rows))};
  };
  std::vector<Following> fits;
  Signal left(rows, joints);
  for (int j = 0; j < joints; ++j) {
    const Joint joint = signals_of(j);
    left.col(j) = Left(joint, fits.emplace_back(Fit(joint, fourier)));
    TrimSignals();
  }
  const FilteredSignal above = Trembling(left, input.rate_hz, input.jitter_above_hz, fourier);
  std::vector<ErrorSplit> splits;
  for (int j = 0; j < joints; ++j) {
    splits.push_back(Split(signals_of(j), fits[static_cast<std::size_t>(j)],
                           Column(above.values.col(j).data(), above.values.rows()),
                           above.first_sample));
    TrimSignals();
  }
  return splits;
}

}  // namespace gauntlet::sim
