#include "sim/glove/faults/digital_faults.h"

#include <algorithm>
#include <cmath>

#include "controller/number.h"

namespace gauntlet::sim {
namespace {

void RepeatTheValueBefore(FaultStrike& strike) {
  const double before = strike.column[std::max<Eigen::Index>(strike.begin - 1, 0)];
  strike.stretch().setConstant(before);
}

void LoseValues(FaultStrike& strike) { strike.stretch().setConstant(controller::kNaN); }

}  // namespace

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
