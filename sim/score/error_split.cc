#include "sim/score/error_split.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <utility>
#include <vector>

#include "controller/assert.h"
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

/// What a tick counts for.
constexpr std::uint8_t kCounted = 1;
constexpr std::uint8_t kFree = 2;         // and no motor of the joint is at its limit, or just was
constexpr std::uint8_t kUndisturbed = 4;  // the high pass there has a share of such ticks only
using TickMarks = std::vector<std::uint8_t>;

/// The signals of one joint.
struct Joint {
  double rate_hz;
  Column reference;
  Column hand;
  Column noise_free_hand;
  TickMarks marks;
};

/// hand(t) ~ constant + gain * reference(t - delay).
struct Following {
  double delay_ticks = 0.0;
  double gain = 1.0;
  double constant_rad = 0.0;
};

void Mark(const CountedTicks& ranges, std::uint8_t mark, TickMarks& marks) {
  for (const TickRange& range : ranges) {
    for (int n = range.begin; n < range.end; ++n) marks[static_cast<std::size_t>(n)] |= mark;
  }
}

/// Takes kFree away while one of the joint's motors is at its limit, and a while after.
void UnmarkLimits(const ScoreInput& input, int joint, TickMarks& marks) {
  const auto rows = static_cast<Index>(marks.size());
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
        for (Index i = begin; i < end; ++i) marks[static_cast<std::size_t>(i)] &= ~kFree;
      }
      begin = n + 1;
    }
  }
}

/// The reference of `delay_ticks` ago, linear between ticks; before the first and beyond the last
/// it goes on as it is there.
VectorXd Delayed(const Column& reference, double delay_ticks) {
  GAUNTLET_ASSERT(reference.size() > 0);
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
VectorXd Means(const Column& values, int step) {
  const Eigen::Map<const Eigen::MatrixXd> blocks(values.data(), step, values.size() / step);
  return blocks.colwise().mean();
}

/// The blocks of `step` ticks between `begin` and `end` of which all ticks have the mark.
std::vector<TickRange> MarkedBlocks(const TickMarks& marks, std::uint8_t mark, int step,
                                    Index begin, Index end) {
  std::vector<TickRange> ranges;
  for (auto block = static_cast<int>(begin); block < end; ++block) {
    const auto first = marks.begin() + static_cast<std::ptrdiff_t>(block) * step;
    if (!std::all_of(first, first + step, [&](std::uint8_t of) { return (of & mark) != 0; })) {
      continue;
    }
    if (ranges.empty() || ranges.back().end != block) ranges.push_back({block, block});
    ++ranges.back().end;
  }
  return ranges;
}

/// Sums of the values within ranges, and of the same ranges moved.
class SumsWithin {
 public:
  SumsWithin(const VectorXd& values, const std::vector<TickRange>& ranges)
      : until_(values.size() + 1), ranges_(ranges) {
    until_[0] = 0.0;
    std::partial_sum(values.begin(), values.end(), until_.begin() + 1);
  }
  double MovedBy(Index by) const {
    GAUNTLET_ASSERT(ranges_.empty() ||
                    (ranges_.front().begin + by >= 0 && ranges_.back().end + by < until_.size()));
    double sum = 0.0;
    for (const TickRange& range : ranges_) sum += until_[range.end + by] - until_[range.begin + by];
    return sum;
  }

 private:
  VectorXd until_;
  const std::vector<TickRange>& ranges_;
};

/// Pearson's correlation of hand and reference within the blocks, at lags from -bound to bound. The
/// same ticks of the hand count at every lag. Empty where the hand stands still.
std::vector<double> Correlations(const VectorXd& reference, const VectorXd& hand,
                                 const std::vector<TickRange>& blocks, Index bound) {
  const Index compared = reference.size() - 2 * bound;
  const double count = CountOf(blocks);
  VectorXd hands = VectorXd::Zero(compared);
  for (const TickRange& range : blocks) {
    hands.segment(range.begin - bound, range.end - range.begin) =
        hand.segment(range.begin, range.end - range.begin);
  }
  const double hand_variation = hands.squaredNorm() - hands.sum() * hands.sum() / count;
  const double still = kStillRms_rad * kStillRms_rad * count;
  std::vector<double> correlations;
  if (!(hand_variation > still)) return correlations;
  const SumsWithin sums(reference, blocks);
  const SumsWithin squares(reference.array().square(), blocks);
  for (Index lag = -bound; lag <= bound; ++lag) {
    const double sum = sums.MovedBy(-lag);
    const double variation = squares.MovedBy(-lag) - sum * sum / count;
    const double covariation =
        reference.segment(bound - lag, compared).dot(hands) - sum * hands.sum() / count;
    correlations.push_back(variation > still ? covariation / std::sqrt(variation * hand_variation)
                                             : 0.0);
  }
  return correlations;
}

/// The lag in ticks at which Pearson's correlation over the ticks with the mark is largest; 0 where
/// there is no such lag, or where the correlation is low.
double FindDelay(const Joint& joint, std::uint8_t mark, Fourier& fourier) {
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
  const std::vector<TickRange> blocks = MarkedBlocks(joint.marks, mark, step, bound, size - bound);
  if (bound < 1 || CountOf(blocks) < kLeastFit_s * rate_hz) return 0.0;
  const std::vector<double> correlations = Correlations(reference, hand, blocks, bound);
  if (correlations.empty()) return 0.0;
  const auto peak = std::ranges::max_element(correlations);
  const bool at_the_bound = peak == correlations.begin() || peak + 1 == correlations.end();
  if (at_the_bound || !(*peak >= kLeastDelayCorrelation)) return 0.0;
  const auto lag = static_cast<double>(peak - correlations.begin() - bound);
  return step * (lag + ParabolaPeak(peak[-1], peak[0], peak[1]));
}

/// Gain and constant by least squares, where the reference of `delay_ticks` ago is known.
Following FitAt(double delay_ticks, const Joint& joint, std::uint8_t mark) {
  const Index ticks = joint.hand.size();
  const auto begin = static_cast<Index>(std::ceil(std::max(0.0, delay_ticks - kRounding_ticks)));
  const Index end =
      ticks + static_cast<Index>(std::floor(std::min(0.0, delay_ticks + kRounding_ticks)));
  Following following{.delay_ticks = delay_ticks};
  const VectorXd delayed = Delayed(joint.reference, delay_ticks);
  const auto for_each = [&](auto add) {
    for (Index n = begin; n < end; ++n) {
      if ((joint.marks[static_cast<std::size_t>(n)] & mark) != 0) {
        add(delayed[n], joint.noise_free_hand[n]);
      }
    }
  };
  double count = 0.0;
  double x_mean = 0.0;
  double y_mean = 0.0;
  for_each([&](double x, double y) {
    ++count;
    x_mean += x;
    y_mean += y;
  });
  if (count == 0.0) return following;
  x_mean /= count;
  y_mean /= count;
  double variation = 0.0;
  double covariation = 0.0;
  for_each([&](double x, double y) {
    variation += (x - x_mean) * (x - x_mean);
    covariation += (x - x_mean) * (y - y_mean);
  });
  if (variation > kStillRms_rad * kStillRms_rad * count) following.gain = covariation / variation;
  following.constant_rad = y_mean - following.gain * x_mean;
  return following;
}

Following Fit(const Joint& joint, Fourier& fourier) {
  const auto free = std::ranges::count_if(joint.marks, [](auto of) { return (of & kFree) != 0; });
  const bool enough = static_cast<double>(free) >= kLeastFit_s * joint.rate_hz;
  const std::uint8_t mark = enough ? kFree : kCounted;
  return FitAt(FindDelay(joint, mark, fourier), joint, mark);
}

/// What the fit leaves of the noise-free hand.
VectorXd Left(const Joint& joint, const Following& fit) {
  return joint.noise_free_hand.array() - fit.constant_rad -
         fit.gain * Delayed(joint.reference, fit.delay_ticks).array();
}

/// `above` is what the fit leaves, above the edge, of the ticks from `first` on.
ErrorSplit Split(const Joint& joint, const Following& fit, const Column& above, Index first) {
  const VectorXd delayed = Delayed(joint.reference, fit.delay_ticks);
  const double mean = delayed.mean();
  double count = 0.0, delay = 0.0, sum = 0.0, gain = 0.0, limit = 0.0, frames = 0.0, noise = 0.0,
         rest = 0.0;
  for (Index n = 0; n < delayed.size(); ++n) {
    const std::uint8_t mark = joint.marks[static_cast<std::size_t>(n)];
    if ((mark & kCounted) == 0) continue;
    ++count;
    const double error = joint.hand[n] - joint.reference[n];
    const double left = joint.noise_free_hand[n] - fit.constant_rad - fit.gain * delayed[n];
    delay += (delayed[n] - joint.reference[n]) * error;
    sum += error;
    gain += (delayed[n] - mean) * error;
    noise += (joint.hand[n] - joint.noise_free_hand[n]) * error;
    if ((mark & kFree) == 0) {
      limit += left * error;
      continue;
    }
    const bool is_above = (mark & kUndisturbed) != 0 && above.size() > 0;
    const double left_above = is_above ? above[n - first] : 0.0;
    frames += left_above * error;
    rest += (left - left_above) * error;
  }
  ErrorSplit split;
  split.Of(ErrorCause::kDelay) = delay;
  split.Of(ErrorCause::kConstant) = (fit.constant_rad + (fit.gain - 1.0) * mean) * sum;
  split.Of(ErrorCause::kGain) = (fit.gain - 1.0) * gain;
  split.Of(ErrorCause::kLimit) = limit;
  split.Of(ErrorCause::kFrames) = frames;
  split.Of(ErrorCause::kNoise) = noise;
  split.Of(ErrorCause::kRest) = rest;
  for (double& part : split.mean_squares) part /= count;
  return split;
}

Joint JointOf(const ScoreInput& input, int joint) {
  const Index rows = input.hand_angle_rad->rows();
  const CountedTicks counted = input.counted != nullptr
                                   ? input.counted->joints[static_cast<std::size_t>(joint)]
                                   : CountedTicks{{0, static_cast<int>(rows)}};
  TickMarks marks(static_cast<std::size_t>(rows), 0);
  Mark(counted, kCounted | kFree, marks);
  Mark(TremblingWithin(counted, input.rate_hz, input.jitter_above_hz), kUndisturbed, marks);
  UnmarkLimits(input, joint, marks);
  const auto column = [&](const Signal& signal) { return Column(signal.col(joint).data(), rows); };
  return {.rate_hz = input.rate_hz,
          .reference = column(*input.reference_angle_rad),
          .hand = column(*input.hand_angle_rad),
          .noise_free_hand = column(*input.noise_free_hand_angle_rad),
          .marks = std::move(marks)};
}

}  // namespace

std::vector<ErrorSplit> SplitErrors(const ScoreInput& input, Fourier& fourier) {
  const Index rows = input.hand_angle_rad->rows();
  if (rows == 0 || input.noise_free_hand_angle_rad == nullptr ||
      input.noise_free_motor_at_limit == nullptr || input.motors_of_joint.empty()) {
    return {};
  }
  const int joints = static_cast<int>(input.hand_angle_rad->cols());
  std::vector<Following> fits;
  Signal left(rows, joints);
  for (int j = 0; j < joints; ++j) {
    const Joint joint = JointOf(input, j);
    left.col(j) = Left(joint, fits.emplace_back(Fit(joint, fourier)));
    TrimSignals();
  }
  const FilteredSignal above = Trembling(left, input.rate_hz, input.jitter_above_hz, fourier);
  std::vector<ErrorSplit> splits;
  for (int j = 0; j < joints; ++j) {
    splits.push_back(Split(JointOf(input, j), fits[static_cast<std::size_t>(j)],
                           Column(above.values.col(j).data(), above.values.rows()),
                           above.first_sample));
    TrimSignals();
  }
  return splits;
}

}  // namespace gauntlet::sim
