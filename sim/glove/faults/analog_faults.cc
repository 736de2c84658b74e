#include "sim/glove/faults/analog_faults.h"

#include "sim/base/normal_pair.h"

namespace gauntlet::sim {
namespace {

void VisitAmplitude(controller::SettingsVisitor& visitor, std::string_view help,
                    double& amplitude_counts) {
  visitor.Number({.key = "amplitude_counts", .help = help, .min = 0, .max = 1e6}, amplitude_counts);
}

}  // namespace

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

}  // namespace gauntlet::sim
