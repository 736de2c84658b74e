#include "sim/score/scored_parts.h"

#include <algorithm>
#include <cmath>

#include "sim/score/delay.h"
#include "sim/score/jitter.h"
#include "sim/score/no_score.h"
#include "sim/score/tracking.h"

namespace gauntlet::sim {
namespace {

std::span<const double> Column(const Signal& signal, int column, Eigen::Index rows) {
  return {signal.col(column).data(), static_cast<std::size_t>(rows)};
}

/// RMS of some values within ranges; value 0 belongs to tick `first_tick`.
double RmsWithin(std::span<const double> values, int first_tick, const std::vector<Range>& ranges) {
  double squares = 0.0;
  int count = 0;
  for (const Range& range : ranges) {
    const int begin = std::max(0, range.begin - first_tick);
    const int end = std::min(static_cast<int>(values.size()), range.end - first_tick);
    for (int n = begin; n < end; ++n) squares += values[n] * values[n];
    count += std::max(0, end - begin);
  }
  return count == 0 ? kNoScore : std::sqrt(squares / count);
}

/// RMS per joint of the trembling that noise adds.
std::vector<double> NoiseJitter(const ScoreInput& input, Fourier& fourier) {
  if (input.noise_free_hand_angle_rad == nullptr) return {};
  const Eigen::Index rows = input.hand_angle_rad->rows();
  const Signal noise = *input.hand_angle_rad - input.noise_free_hand_angle_rad->topRows(rows);
  const Signal high = Trembling(noise, input.rate_hz, input.jitter_above_hz, fourier).values;
  std::vector<double> jitter;
  for (int joint = 0; joint < high.cols(); ++joint) {
    jitter.push_back(Rms(Column(high, joint, high.rows())));
    TrimSignals();
  }
  return jitter;
}

}  // namespace

AllJoints::AllJoints(const ScoreInput& input, Fourier& fourier)
    : trembling([&input, &fourier] {
        return Trembling(*input.hand_angle_rad, input.rate_hz, input.jitter_above_hz, fourier);
      }),
      noise_jitter_rad([&input, &fourier] { return NoiseJitter(input, fourier); }),
      error_splits([&input, &fourier] { return SplitErrors(input, fourier); }) {}

ScoredJoint::ScoredJoint(const ScoreInput& input, int column, const AllJoints& all,
                         Fourier& fourier)
    : rate_hz(input.rate_hz),
      reference_rad(Column(*input.reference_angle_rad, column, input.hand_angle_rad->rows())),
      hand_rad(Column(*input.hand_angle_rad, column, input.hand_angle_rad->rows())),
      error_rad([this] {
        std::vector<double> error(hand_rad.size());
        for (std::size_t n = 0; n < error.size(); ++n) error[n] = hand_rad[n] - reference_rad[n];
        return error;
      }),
      wearer([this, &input] { return AnalyseWearer(reference_rad, rate_hz, input.segments); }),
      delay_ticks(
          [this, &fourier] { return DelaySamples(reference_rad, hand_rad, rate_hz, fourier); }),
      smoothness([this, &fourier] {
        return MovementSmoothness(hand_rad, rate_hz, wearer().movements,
                                  delay_ticks().value_or(0.0), fourier);
      }),
      column_(column),
      all_(all) {}

std::span<const double> ScoredJoint::trembling_rad() const {
  const Signal& values = all_.trembling().values;
  return Column(values, column_, values.rows());
}

double ScoredJoint::noise_jitter_rad() const {
  const std::vector<double>& jitter = all_.noise_jitter_rad();
  return jitter.empty() ? kNoScore : jitter[column_];
}

double ScoredJoint::ErrorDuring(Regime regime) const {
  return RmsWithin(error_rad(), 0, wearer().Of(regime));
}

double ScoredJoint::TremblingDuring(Regime regime) const {
  return RmsWithin(trembling_rad(), all_.trembling().first_sample, wearer().Of(regime));
}

double ScoredJoint::PartOfError(ErrorCause cause) const {
  const std::vector<ErrorSplit>& splits = all_.error_splits();
  return splits.empty() ? kNoScore : splits[column_].Of(cause);
}

}  // namespace gauntlet::sim
