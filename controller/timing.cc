#include "controller/timing.h"

#include <cmath>

namespace gauntlet::controller {
namespace {

constexpr double kMostRate_hz = 1e5;

}  // namespace

double Timing::TicksOf(double duration_ms) const {
  const double ticks = duration_ms * 1e-3 * tick_rate_hz;
  return std::abs(ticks - std::round(ticks)) < 1e-9 ? std::round(ticks) : ticks;
}

void Timing::Visit(SettingsVisitor& visitor) {
  visitor.Number({"tick_rate_hz", "steps of the control loop per second", 1, kMostRate_hz},
                 tick_rate_hz);
  visitor.Integer({"ticks_per_sample",
                   "the glove brings a new sample at every so many steps of the loop", 1, 100000},
                  ticks_per_sample);
  visitor.Number({"event_period_ms", "time between two command frames", 0.01, 1e5},
                 event_period_ms);
  const Setting glove_rate = {
      "glove_rate_hz", "samples of the glove per second; 0: one at every ticks_per_sample-th step",
      0, kMostRate_hz};
  if (visitor.ShowsOptional(glove_rate, glove_rate_hz != 0.0)) {
    visitor.Number(glove_rate, glove_rate_hz);
  }
}

Timing WithTickRate(const Timing& timing, double tick_rate_hz) {
  const double glove_rate_hz = timing.sample_rate_hz();
  if (!(tick_rate_hz >= glove_rate_hz && tick_rate_hz <= kMostRate_hz)) {
    throw SettingError("tick_rate_hz",
                       "is " + NumberText(tick_rate_hz) + ", must be from the rate of the glove, " +
                           NumberText(glove_rate_hz) + ", to " + NumberText(kMostRate_hz));
  }
  Timing other = timing;
  other.tick_rate_hz = tick_rate_hz;
  other.ticks_per_sample = static_cast<int>(std::lround(tick_rate_hz / glove_rate_hz));
  other.glove_rate_hz = 0.0;
  if (other.sample_rate_hz() != glove_rate_hz) other.glove_rate_hz = glove_rate_hz;
  return other;
}

}  // namespace gauntlet::controller
