#include "sim/glove/faults/fault.h"

namespace gauntlet::sim {

void FaultOccurrence::Visit(controller::SettingsVisitor& visitor) {
  visitor.Texts({.key = "channels", .help = "names of the channels; empty: all"}, channels);
  visitor.Number(
      {.key = "start_s", .help = "when it comes first; below 0: at random", .min = -1, .max = 3600},
      start_s);
  visitor.Number({.key = "rate_per_s",
                  .help = "how often it comes (again), on average; 0: never",
                  .min = 0,
                  .max = 1000},
                 rate_per_s);
  visitor.Number({.key = "duration_ms",
                  .help = "mean duration, at least one sample; 0: it stays to the end",
                  .min = 0,
                  .max = 600000},
                 duration_ms);
}

}  // namespace gauntlet::sim
