#include "sim/base/timing.h"

#include <cmath>

#include "controller/assert.h"

namespace gauntlet::sim {
namespace {

/// Joints move below 10 Hz and jitter below 100 Hz, so 1 ms resolves both.
constexpr double kLongestTickMs = 1.0;

/// The smallest number of equal parts that are not longer than `longest_ms`.
int PartsOf(double whole_ms, double longest_ms) {
  GAUNTLET_ASSERT(whole_ms > 0.0 && longest_ms > 0.0);
  constexpr double kRounding = 1e-9;
  return static_cast<int>(std::ceil(whole_ms / longest_ms - kRounding));
}

}  // namespace

controller::Timing MakeGloveTiming(double sample_rate_hz) {
  const int parts = PartsOf(1e3 / sample_rate_hz, kLongestTickMs);
  const int ticks = parts > 1 ? parts : 1;
  return {.tick_rate_hz = sample_rate_hz * ticks, .ticks_per_sample = ticks};
}

LoopTiming MakeLoopTiming(const ClockSettings& settings) {
  LoopTiming timing;
  timing.controller = MakeGloveTiming(settings.sample_rate_hz);
  timing.controller.event_period_ms = settings.event_period_ms;
  timing.event_delay_ticks =
      static_cast<int>(std::lround(timing.controller.TicksOf(settings.event_delay_ms)));
  timing.steps_per_tick = PartsOf(1e3 / timing.tick_rate_hz(), settings.longest_step_ms);
  return timing;
}

}  // namespace gauntlet::sim
