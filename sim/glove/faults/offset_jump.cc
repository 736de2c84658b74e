#include "sim/glove/faults/offset_jump.h"

namespace gauntlet::sim {

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
