#pragma once

#include <cmath>
#include <cstdint>

#include "controller/assert.h"

namespace gauntlet::controller {

/// Tells at which ticks something periodic happens: the first tick at or after each multiple of the
/// period. Time is whole multiples of the period, so that nothing drifts. Units: ticks, from 0.
class PeriodicClock {
 public:
  /// `period_ticks` may be any number above 0; up to 1 is every tick.
  explicit PeriodicClock(double period_ticks) : period_(period_ticks) {
    GAUNTLET_ASSERT(period_ticks > 0.0);
  }

  /// True if it happens at this tick; the next call is about the next tick.
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
