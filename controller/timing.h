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
  /// Samples of the glove per second, where its period is not a whole number of ticks (a glove of
  /// 90 Hz in a loop of 1000 Hz); `ticks_per_sample` is the nearest number then. 0: its period is
  /// `ticks_per_sample`.
  double glove_rate_hz = 0.0;

  double sample_rate_hz() const {
    return glove_rate_hz > 0.0 ? glove_rate_hz : tick_rate_hz / ticks_per_sample;
  }
  double event_rate_hz() const { return tick_rate_hz / TicksOf(event_period_ms); }
  /// A duration in ticks, which may be a fraction. What is whole but for rounding is whole.
  double TicksOf(double duration_ms) const;

  void Visit(SettingsVisitor& visitor);
};

/// Timing of a glove of the rate of `timing` in a loop of another rate. Errors: SettingError for a
/// loop that is slower than the glove.
GAUNTLET_API Timing WithTickRate(const Timing& timing, double tick_rate_hz);

/// How a control loop keeps to its Timing, by the time between its steps as it measured it.
enum class LoopStatus {
  kInTime,     // or the loop measures nothing
  kOverrun,    // the last step came half a tick late or more
  kWrongRate,  // most steps are too long or too short by more than 5 %: filters, delays and limits
               // are wrong by as much
};

}  // namespace gauntlet::controller
