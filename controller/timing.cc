#include "controller/timing.h"

#include <cmath>

namespace gauntlet::controller {

double Timing::TicksOf(double duration_ms) const {
  const double ticks = duration_ms * 1e-3 * tick_rate_hz;
  return std::abs(ticks - std::round(ticks)) < 1e-9 ? std::round(ticks) : ticks;
}

void Timing::Visit(SettingsVisitor& visitor) {
  visitor.Number({"tick_rate_hz", "steps of the control loop per second", 1, 1e5}, tick_rate_hz);
  visitor.Integer({"ticks_per_sample",
                   "the glove brings a new sample at every so many steps of the loop", 1, 100000},
                  ticks_per_sample);
  visitor.Number({"event_period_ms", "time between two command frames", 0.01, 1e5},
                 event_period_ms);
}

}  // namespace gauntlet::controller
