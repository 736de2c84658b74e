#include "sim/score/scored_parts.h"

#include <algorithm>
#include <cmath>

#include "controller/assert.h"
#include "sim/score/delay.h"
#include "sim/score/jitter.h"
#include "sim/score/no_score.h"
#include "sim/score/tracking.h"

namespace gauntlet::sim {
namespace {

std::span<const double> Column(const Signal& signal, int column, Eigen::Index rows) {
  GAUNTLET_ASSERT(rows <= signal.rows() && 0 <= column && column < signal.cols());
  return {signal.col(column).data(), static_cast<std::size_t>(rows)};
}

/// RMS per joint of the jitter that noise adds.
std::vector<double> NoiseJitter(const AllJoints& all, Fourier& fourier) {
  const ScoreInput& input = all.input;
  if (input.noise_free_hand_angle_rad == nullptr) return {};
  const Eigen::Index rows = input.hand_angle_rad->rows();
  const Signal noise = *input.hand_angle_rad - input.noise_free_hand_angle_rad->topRows(rows);
  const FilteredSignal high = Trembling(noise, input.rate_hz, input.jitter_above_hz, fourier);
  std::vector<double> jitter;
  for (int joint = 0; joint < high.values.cols(); ++joint) {
    const CountedTicks counted = TremblingWithin(all.CountedOf(&CountedParts::joints, joint),
                                                 input.rate_hz, input.jitter_above_hz);
    jitter.push_back(
        RmsWithin(Column(high.values, joint, high.values.rows()), high.first_sample, counted));
    TrimSignals();
  }
  return jitter;
}

}  // namespace

AllJoints::AllJoints(const ScoreInput& scored, Fourier& fourier)
    : input(scored),
      trembling([this, &fourier] {
        return Trembling(*input.hand_angle_rad, input.rate_hz, input.jitter_above_hz, fourier);
      }),
      trembling_at_rest([this, &fourier] {
        if (input.arm_at_rest_angle_rad == nullptr) return FilteredSignal();
        return Trembling(input.arm_at_rest_angle_rad->topRows(TicksAtRest()), input.rate_hz,
                         input.jitter_above_hz, fourier);
      }),
      trembling_beside_rest([this, &fourier] {
        if (TicksAtRest() == input.hand_angle_rad->rows()) return trembling();
        return Trembling(input.hand_angle_rad->topRows(TicksAtRest()), input.rate_hz,
                         input.jitter_above_hz, fourier);
      }),
      noise_jitter_rad([this, &fourier] { return NoiseJitter(*this, fourier); }) {}

double AllJoints::GroupJitter_rad(const FilteredSignal& jitter, std::span<const ScoredGroup> groups,
                                  ScoredGroup group, Eigen::Index ticks) const {
  double sum_rad = 0.0;
  int joints = 0;
  for (int joint = 0; joint < std::ssize(groups); ++joint) {
    if (groups[joint] != group || jitter.values.rows() == 0) continue;
    const CountedTicks counted = TremblingWithin(
        Overlap({{0, static_cast<int>(ticks)}}, CountedOf(&CountedParts::joints, joint)),
        input.rate_hz, input.jitter_above_hz);
    const double rms_rad =
        RmsWithin(Column(jitter.values, joint, jitter.values.rows()), jitter.first_sample, counted);
    TrimSignals();
    if (!std::isfinite(rms_rad)) continue;
    sum_rad += rms_rad;
    ++joints;
  }
  return joints == 0 ? kNoScore : sum_rad / joints;
}

Eigen::Index AllJoints::TicksAtRest() const {
  const Signal* const at_rest = input.arm_at_rest_angle_rad;
  return at_rest == nullptr ? 0 : std::min(at_rest->rows(), input.hand_angle_rad->rows());
}

CountedTicks AllJoints::CountedOf(const std::vector<CountedTicks> CountedParts::*parts,
                                  int part) const {
  if (input.counted != nullptr) return (input.counted->*parts)[static_cast<std::size_t>(part)];
  return {{0, static_cast<int>(input.hand_angle_rad->rows())}};
}

CountedTicks AllJoints::CountedOfHand() const {
  if (input.counted != nullptr) return input.counted->hand;
  return {{0, static_cast<int>(input.hand_angle_rad->rows())}};
}

ScoredJoint::ScoredJoint(const ScoreInput& input, int column, const AllJoints& all,
                         Fourier& fourier)
    : rate_hz(input.rate_hz),
      reference_rad(Column(*input.reference_angle_rad, column, input.hand_angle_rad->rows())),
      hand_rad(Column(*input.hand_angle_rad, column, input.hand_angle_rad->rows())),
      counted(all.CountedOf(&CountedParts::joints, column)),
      error_rad([this] { return Differences(hand_rad, reference_rad); }),
      wearer([this, &input] {
        return AnalyseWearer(reference_rad, rate_hz, input.segments, counted);
      }),
      delay_ticks([this, &input, &fourier] {
        return DelaySamples(reference_rad, hand_rad, rate_hz, input.earliest_delay_s, counted,
                            fourier);
      }),
      smoothness([this, &fourier] {
        return MovementSmoothness(hand_rad, rate_hz, wearer().movements,
                                  delay_ticks().value_or(0.0), fourier);
      }),
      error_parts([this, &input, column] {
        std::array<std::span<const double>, kCauseTrialCount> without;
        for (std::size_t i = 0; i < without.size(); ++i) {
          if (input.without[i] == nullptr) continue;
          without[i] = Column(*input.without[i], column, input.hand_angle_rad->rows());
        }
        return PartsOfError(reference_rad, hand_rad, without, counted);
      }),
      column_(column),
      all_(all),
      trembling_counted_(TremblingWithin(counted, rate_hz, input.jitter_above_hz)) {}

std::span<const double> ScoredJoint::trembling_rad() const {
  const Signal& values = all_.trembling().values;
  return Column(values, column_, values.rows());
}

double ScoredJoint::jitter_rad() const {
  return RmsWithin(trembling_rad(), all_.trembling().first_sample, trembling_counted_);
}

double ScoredJoint::noise_jitter_rad() const {
  const std::vector<double>& jitter = all_.noise_jitter_rad();
  return jitter.empty() ? kNoScore : jitter[column_];
}

double ScoredJoint::ErrorDuring(Regime regime) const {
  return RmsWithin(error_rad(), 0, wearer().Of(regime));
}

double ScoredJoint::TremblingDuring(Regime regime) const {
  return RmsWithin(trembling_rad(), all_.trembling().first_sample,
                   Overlap(wearer().Of(regime), trembling_counted_));
}

double ScoredJoint::PartOfError(ErrorCause cause) const {
  const std::optional<ErrorByCauses>& parts = error_parts();
  return parts ? (*parts)[static_cast<std::size_t>(cause)] : kNoScore;
}

double ScoredJoint::ErrorOfSwitched(const Signal* hand) const {
  const int ticks = all_.input.switched_off_ticks;
  if (ticks == 0 || hand == nullptr) return kNoScore;
  return RmsWithin(Differences(Column(*hand, column_, ticks), reference_rad), 0,
                   Overlap({{0, ticks}}, counted));
}

double ScoredJoint::ErrorWithAll() const { return ErrorOfSwitched(all_.input.hand_angle_rad); }

double ScoredJoint::ErrorWithout(ErrorCause cause) const {
  const auto place = std::ranges::find(kSwitchedCauses, cause) - kSwitchedCauses.begin();
  return ErrorOfSwitched(all_.input.switched_off[static_cast<std::size_t>(place)]);
}

}  // namespace gauntlet::sim
