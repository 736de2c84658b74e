#include "sim/glove/faults/fault.h"

namespace gauntlet::sim {

void FaultOccurrence::Visit(controller::SettingsVisitor& visitor) {
  visitor.Texts({"channels", "names of the channels; empty: all"}, channels);
  visitor.Number({"start_s", "when it comes first; below 0: at random", -1, 3600}, start_s);
  visitor.Number({"rate_per_s", "how often it comes (again), on average; 0: never", 0, 1000},
                 rate_per_s);
  visitor.Number(
      {"duration_ms", "mean duration, at least one sample; 0: it stays to the end", 0, 600000},
      duration_ms);
}

}  // namespace gauntlet::sim
