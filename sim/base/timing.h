#pragma once

#include "controller/timing.h"

namespace gauntlet::sim {

/// Settings of the clocks, as a person gives them.
struct ClockSettings {
  double sample_rate_hz = 1000.0;  // of the glove
  double event_period_ms = 20.0;
  double event_delay_ms = 25.0;
  double longest_step_ms = 1.0;  // of the physics engine
};

/// The clocks of a trial, made once from its settings. No other code converts times to samples.
///
///     tick    time step of a trial, one row of the trace: the sampling period divided by the
///             smallest whole number that makes it 1 ms or less
///     sample  of the glove: every `controller.ticks_per_sample`-th tick, held in between
///     event   the first tick at or after each multiple of the event period
///     step    of the physics engine: a tick has `steps_per_tick` of them
///
/// A glove of 1000 Hz has ticks of 1 ms, a glove of 60 Hz has ticks of 1000 / (17 60) ms = 0.98 ms.
struct LoopTiming {
  controller::Timing controller;
  int event_delay_ticks = 25;
  int steps_per_tick = 1;

  double tick_rate_hz() const { return controller.tick_rate_hz; }
  double step_s() const { return 1.0 / (controller.tick_rate_hz * steps_per_tick); }
};

/// Ticks per sample and per second for a glove with this rate, with the default event period.
controller::Timing MakeGloveTiming(double sample_rate_hz);
LoopTiming MakeLoopTiming(const ClockSettings& settings);

}  // namespace gauntlet::sim
