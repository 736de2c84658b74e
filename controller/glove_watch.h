#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "controller/sample_guard.h"
#include "controller/timing.h"

namespace gauntlet::controller {

/// Holds the calls of a control loop against its Timing, and knows how old each channel's last
/// trusted value is. Its clock is the number of ticks, there is no other.
///
/// With P = ticks_per_sample, a sample is overdue from P + P / 2 ticks (rounded down) after the
/// last one, and again every P ticks; the first one is due at the first tick. Samples come too
/// often if 64 of them took less than 3/4 of their time.
class GloveWatch {
 public:
  GloveWatch(const SampleGuardConfig& config, const Timing& timing, int channel_count);

  /// A tick begins, with a sample or without one. True: a sample is overdue.
  bool Tick(bool has_sample) noexcept;
  /// Takes the guard's results for the sample of this tick.
  void ReadResults(const SampleGuard& guard) noexcept;
  /// As new.
  void Reset() noexcept;
  /// Goes on where another watch of the same glove stands. Settings stay.
  void SwapMemory(GloveWatch& from) noexcept;

  /// True if channels can be lost.
  bool on() const noexcept { return lost_ticks_ < std::numeric_limits<double>::infinity(); }
  bool too_often() const noexcept { return too_often_; }
  /// Since the last trusted value of the channel, or Reset() if there was none.
  std::int64_t ticks_since_trusted(std::size_t channel) const noexcept {
    return tick_ - (all_trusted_tick_ > trusted_tick_[channel] ? all_trusted_tick_
                                                               : trusted_tick_[channel]);
  }
  bool lost(std::size_t channel) const noexcept {
    return static_cast<double>(ticks_since_trusted(channel)) >= lost_ticks_;
  }

 private:
  double lost_ticks_;  // infinite: never
  std::int64_t ticks_per_sample_;
  std::int64_t tick_ = -1;         // of the last call
  std::int64_t overdue_tick_ = 0;  // when the next sample is overdue
  std::int64_t window_tick_ = 0;   // where the present 64 samples began
  std::int64_t window_samples_ = 0;
  bool too_often_ = false;
  std::int64_t all_trusted_tick_ = 0;       // of the last sample of trusted values alone
  std::vector<std::int64_t> trusted_tick_;  // per channel, of a sample that has others, too
};

}  // namespace gauntlet::controller
