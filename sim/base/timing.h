#pragma once

#include "controller/timing.h"

namespace gauntlet::sim {

/// What a person says of time.
struct ClockSettings {
  double sample_rate_hz = 1000.0;  // of the glove
  double event_period_ms = 20.0;
  double event_delay_ms = 25.0;
  double longest_step_ms = 1.0;  // of the physics engine
};

/// The clocks of a trial, made once from its settings; nobody else turns times into samples.
///
///     tick    what a trial advances by and keeps a row of: the sampling period divided by the
///             smallest whole number that makes it 1 ms or less
///     sample  of the glove: every `controller.ticks_per_sample`-th tick; in between it is held
///     event   the first tick at or after each multiple of the event period
///     step    of the physics engine: `steps_per_tick` of them make a tick
///
/// A glove of 1000 Hz has ticks of 1 ms, one of 60 Hz ticks of 1000 / (17 60) ms = 0.98 ms.
struct LoopTiming {
  controller::Timing controller;
  int event_delay_ticks = 25;
  int steps_per_tick = 1;

  double tick_rate_hz() const { return controller.tick_rate_hz; }
  double step_s() const { return 1.0 / (controller.tick_rate_hz * steps_per_tick); }
};

/// Ticks per sample and per second of a glove with this rate; events stay as they are by default.
controller::Timing MakeGloveTiming(double sample_rate_hz);
LoopTiming MakeLoopTiming(const ClockSettings& settings);

}  // namespace gauntlet::sim
