#pragma once

#include "controller/export.h"
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
struct GAUNTLET_API Timing {
  double tick_rate_hz = 1000.0;
  int ticks_per_sample = 1;
  double event_period_ms = 20.0;

  double sample_rate_hz() const { return tick_rate_hz / ticks_per_sample; }
  double event_rate_hz() const { return tick_rate_hz / TicksOf(event_period_ms); }
  /// A duration in ticks, which may be a fraction. What is whole but for rounding is whole.
  double TicksOf(double duration_ms) const;

  void Visit(SettingsVisitor& visitor);
};

}  // namespace gauntlet::controller
