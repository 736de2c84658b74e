#pragma once

#include <cmath>
#include <cstdint>

#include "controller/assert.h"
#include "controller/settings.h"

namespace gauntlet::controller {

/// The clocks of a control loop. All of them count ticks, the loop's own steps.
///
///     tick    Controller::Step() once per tick
///     sample  the glove brings a new one at every `ticks_per_sample`-th tick, beginning with the
///             first; in between there is nothing new
///     event   a command frame: at the first tick at or after j event_period_ms, j = 0, 1, ..;
///             a period need not be a whole number of ticks or of samples
///
/// Source of the defaults: Bai, Jiang, Yokoi, section 4: 1000 samples per second, an event every
/// 0.02 s.
struct Timing {
  double tick_rate_hz = 1000.0;
  int ticks_per_sample = 1;
  double event_period_ms = 20.0;

  double sample_rate_hz() const { return tick_rate_hz / ticks_per_sample; }
  double event_rate_hz() const { return tick_rate_hz / TicksOf(event_period_ms); }
  /// A duration in ticks, which may be a fraction. What is whole but for rounding is whole.
  double TicksOf(double duration_ms) const {
    const double ticks = duration_ms * 1e-3 * tick_rate_hz;
    return std::abs(ticks - std::round(ticks)) < 1e-9 ? std::round(ticks) : ticks;
  }

  void Visit(SettingsVisitor& visitor) {
    visitor.Number({"tick_rate_hz", "steps of the control loop per second", 1, 1e5}, tick_rate_hz);
    visitor.Integer({"ticks_per_sample",
                     "the glove brings a new sample at every so many steps of the loop", 1, 100000},
                    ticks_per_sample);
    visitor.Number({"event_period_ms", "time between two command frames", 0.01, 1e5},
                   event_period_ms);
  }
};

/// Tells at which ticks something periodic happens: the first tick at or after each multiple of the
/// period. Time is whole multiples of the period, so that nothing drifts. Units: ticks, from 0.
class PeriodicClock {
 public:
  /// `period_ticks` may be any number above 0; up to 1 is every tick.
  explicit PeriodicClock(double period_ticks) : period_(period_ticks) {
    GAUNTLET_ASSERT(period_ticks > 0.0);
  }

  /// Whether it happens at this tick; the next call is about the next tick.
  bool Tick() noexcept {
    const auto now = static_cast<double>(tick_++);
    if (now < next_) return false;
    constexpr double kRounding = 1e-6;
    const double periods = std::floor((now + kRounding) / period_) + 1.0;
    next_ = std::ceil(periods * period_ - kRounding);
    return true;
  }
  void Reset() noexcept {
    tick_ = 0;
    next_ = 0.0;
  }

 private:
  double period_;
  std::int64_t tick_ = 0;
  double next_ = 0.0;
};

}  // namespace gauntlet::controller
