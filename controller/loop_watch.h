#pragma once

#include <cstdint>
#include <limits>

#include "controller/timing.h"

namespace gauntlet::controller {

/// Holds the time between the steps of a control loop, as the loop measured it, against its Timing.
///
/// A step is an overrun if it came half a tick late or more. The rate is wrong if more than half of
/// the last 256 intervals were too long, or too short, by more than 5 %, and so is their mean. A
/// loop that measures nothing is taken to be in time.
class LoopWatch {
 public:
  explicit LoopWatch(const Timing& timing) : tick_ms_(1e3 / timing.tick_rate_hz) {}

  /// Time between the last step and the one that follows. Ignores what is not above 0.
  void TakeElapsedTime(double elapsed_ms) noexcept;
  /// A step begins.
  LoopStatus Tick() noexcept;
  /// As new.
  void Reset() noexcept { *this = LoopWatch(tick_ms_); }

  std::int64_t overruns() const noexcept { return overruns_; }
  /// Mean of the last 256 intervals; NaN before.
  double measured_rate_hz() const noexcept { return measured_rate_hz_; }

 private:
  explicit LoopWatch(double tick_ms) : tick_ms_(tick_ms) {}
  void EndWindow() noexcept;

  double tick_ms_;
  double elapsed_ms_ = 0.0;  // 0: not measured
  std::int64_t overruns_ = 0;
  bool is_wrong_ = false;
  double measured_rate_hz_ = std::numeric_limits<double>::quiet_NaN();
  // In the present window.
  std::int64_t steps_ = 0;
  std::int64_t too_long_ = 0;
  std::int64_t too_short_ = 0;
  double sum_ms_ = 0.0;
};

}  // namespace gauntlet::controller
