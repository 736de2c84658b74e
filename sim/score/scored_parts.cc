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
    : trembling(Trembling(*input.hand_angle_rad, input.rate_hz, input.jitter_above_hz, fourier)),
      noise_jitter_rad(NoiseJitter(input, fourier)),
      error_splits(SplitErrors(input, fourier)) {}

ScoredJoint::ScoredJoint(const ScoreInput& input, int column, const AllJoints& all,
                         Fourier& fourier)
    : rate_hz(input.rate_hz),
      reference_rad(Column(*input.reference_angle_rad, column, input.hand_angle_rad->rows())),
      hand_rad(Column(*input.hand_angle_rad, column, input.hand_angle_rad->rows())),
      error_rad(hand_rad.size()),
      trembling_rad(Column(all.trembling.values, column, all.trembling.values.rows())),
      first_trembling_tick(all.trembling.first_sample),
      wearer(AnalyseWearer(reference_rad, rate_hz, input.segments)),
      delay_ticks(DelaySamples(reference_rad, hand_rad, rate_hz, fourier)),
      smoothness(MovementSmoothness(hand_rad, rate_hz, wearer.movements, delay_ticks.value_or(0.0),
                                    fourier)),
      noise_jitter_rad(all.noise_jitter_rad.empty() ? kNoScore : all.noise_jitter_rad[column]) {
  if (!all.error_splits.empty()) error_split = all.error_splits[column];
  for (std::size_t n = 0; n < error_rad.size(); ++n) error_rad[n] = hand_rad[n] - reference_rad[n];
}

double ScoredJoint::ErrorDuring(Regime regime) const {
  return RmsWithin(error_rad, 0, wearer.Of(regime));
}

double ScoredJoint::TremblingDuring(Regime regime) const {
  return RmsWithin(trembling_rad, first_trembling_tick, wearer.Of(regime));
}

double ScoredJoint::PartOfError(ErrorCause cause) const {
  return error_split ? error_split->Of(cause) : kNoScore;
}

}  // namespace gauntlet::sim
