#include "sim/score/error_split.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "controller/assert.h"
#include "sim/score/delay.h"
#include "sim/score/jitter.h"

namespace gauntlet::sim {
namespace {

constexpr double kAfterLimit_s = 0.25;
constexpr double kShortestLimit_s = 0.02;
constexpr double kLeastFit_s = 0.5;
constexpr double kRounding_ticks = 1e-6;  // a delay is whole ticks up to it

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

/// The ranges of ticks that have the mark.
CountedTicks MarkedRanges(const TickMarks& marks, std::uint8_t mark) {
  CountedTicks ranges;
  for (int n = 0; n < static_cast<int>(marks.size()); ++n) {
    if ((marks[static_cast<std::size_t>(n)] & mark) == 0) continue;
    if (ranges.empty() || ranges.back().end != n) ranges.push_back({n, n});
    ranges.back().end = n + 1;
  }
  return ranges;
}

/// The delay of the noise-free hand over the ticks with the mark; 0 if there is none.
double FindDelay(const Joint& joint, std::uint8_t mark, double earliest_s, Fourier& fourier) {
  const auto span = [](const Column& column) {
    return std::span(column.data(), static_cast<std::size_t>(column.size()));
  };
  return DelaySamples(span(joint.reference), span(joint.noise_free_hand), joint.rate_hz, earliest_s,
                      MarkedRanges(joint.marks, mark), fourier)
      .value_or(0.0);
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

Following Fit(const Joint& joint, double earliest_s, Fourier& fourier) {
  const auto free = std::ranges::count_if(joint.marks, [](auto of) { return (of & kFree) != 0; });
  const bool enough = static_cast<double>(free) >= kLeastFit_s * joint.rate_hz;
  const std::uint8_t mark = enough ? kFree : kCounted;
  return FitAt(FindDelay(joint, mark, earliest_s, fourier), joint, mark);
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
    left.col(j) = Left(joint, fits.emplace_back(Fit(joint, input.earliest_delay_s, fourier)));
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
