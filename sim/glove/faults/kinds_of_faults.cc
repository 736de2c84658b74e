#include "sim/glove/faults/kinds_of_faults.h"

#include <algorithm>
#include <cmath>

#include "controller/number.h"
#include "sim/base/normal_pair.h"

namespace gauntlet::sim {
namespace {

void VisitAmplitude(controller::SettingsVisitor& visitor, std::string_view help,
                    double& amplitude_counts) {
  visitor.Number({.key = "amplitude_counts", .help = help, .min = 0, .max = 1e6}, amplitude_counts);
}

void RepeatTheValueBefore(FaultStrike& strike) {
  const double before = strike.column[std::max<Eigen::Index>(strike.begin - 1, 0)];
  strike.stretch().setConstant(before);
}

void LoseValues(FaultStrike& strike) { strike.stretch().setConstant(controller::kNaN); }

}  // namespace

void TimeJitterFault::Visit(controller::SettingsVisitor& visitor) {
  visitor.Number({"deviation_ms", "standard deviation of the moment of sampling", 0, 100},
                 deviation_ms);
}

void TimeJitterFault::Apply(FaultStrike& strike) const {
  const double deviation = 1e-3 * deviation_ms * strike.rate_hz;
  const auto reach = static_cast<Eigen::Index>(6.0 * deviation) + 1;  // beyond: twice in 10^9
  const Eigen::Index first = std::max<Eigen::Index>(strike.begin - reach, 0);
  const Eigen::Index last = std::min(strike.end + reach, strike.column.size()) - 1;
  const Eigen::VectorXd exact = strike.column.segment(first, last - first + 1);
  for (Eigen::Index i = strike.begin; i < strike.end; ++i) {
    const double off = deviation * BoxMuller(strike.random).first;
    const double place = std::clamp(static_cast<double>(i - first) + off, 0.0,
                                    static_cast<double>(exact.size() - 1));
    const auto before = static_cast<Eigen::Index>(place);
    const auto after = std::min(before + 1, exact.size() - 1);
    const double share = place - static_cast<double>(before);
    strike.column[i] = exact[before] + share * (exact[after] - exact[before]);
  }
}

void SpikeFault::Visit(controller::SettingsVisitor& visitor) {
  VisitAmplitude(visitor, "largest jump, of a 10-bit converter's counts", amplitude_counts);
}

void SpikeFault::Apply(FaultStrike& strike) const {
  const double direction = strike.random.Bits() >> 63 ? 1.0 : -1.0;
  const double share = strike.random.Uniform(0.5, 1.0);
  strike.stretch().array() += direction * strike.ScaledCounts(amplitude_counts) * share;
}

void NoiseBurstFault::Visit(controller::SettingsVisitor& visitor) {
  VisitAmplitude(visitor, "standard deviation, of a 10-bit converter's counts", amplitude_counts);
}

void NoiseBurstFault::Apply(FaultStrike& strike) const {
  const double deviation = strike.ScaledCounts(amplitude_counts);
  for (double& value : strike.stretch()) value += deviation * BoxMuller(strike.random).first;
}

void GainChangeFault::Visit(controller::SettingsVisitor& visitor) {
  visitor.Number({"gain", "factor on what the sensor gives", 0, 10}, gain);
}

void GainChangeFault::Apply(FaultStrike& strike) const {
  const double middle = 0.5 * (strike.converter.min_counts + strike.converter.full_scale_counts);
  strike.stretch() = middle + gain * (strike.stretch().array() - middle);
}

void OffsetJumpFault::Visit(controller::SettingsVisitor& visitor) {
  visitor.Number({"offset_counts",
                  "how far the signal moves, up or down, of a 10-bit converter's counts", 0, 1e6},
                 offset_counts);
}

void OffsetJumpFault::Apply(FaultStrike& strike) const {
  const double direction = strike.random.Bits() >> 63 ? 1.0 : -1.0;
  strike.stretch().array() += direction * strike.ScaledCounts(offset_counts);
}

void SaturatedFault::Apply(FaultStrike& strike) const {
  strike.stretch().setConstant(strike.random.Bits() >> 63 ? strike.converter.full_scale_counts
                                                          : strike.converter.min_counts);
}

void StuckFault::Apply(FaultStrike& strike) const { RepeatTheValueBefore(strike); }

void DisconnectedFault::Apply(FaultStrike& strike) const { LoseValues(strike); }

void DropoutFault::Apply(FaultStrike& strike) const { LoseValues(strike); }

void DuplicatedFrameFault::Apply(FaultStrike& strike) const { RepeatTheValueBefore(strike); }

void LateFrameFault::Visit(controller::SettingsVisitor& visitor) {
  visitor.Number({"delay_ms", "delay", 1, 10000}, delay_ms);
}

void LateFrameFault::Apply(FaultStrike& strike) const {
  const auto late = std::max<Eigen::Index>(1, std::lround(1e-3 * delay_ms * strike.rate_hz));
  for (Eigen::Index i = strike.end - 1; i >= strike.begin; --i) {
    strike.column[i] = strike.column[std::max<Eigen::Index>(i - late, 0)];
  }
}

}  // namespace gauntlet::sim
