#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "sim/live/live_session.h"
#include "sim/live/real_time.h"
#include "sim/live/session_log.h"
#include "sim/live/stage_clock.h"
#include "sim/trial/loop/hand_loop.h"

namespace gauntlet::sim {

/// A tick in real time.
struct LiveTick {
  const PeriodicWake& wake;
  std::int64_t woken_ns = 0;
  SessionLog* log = nullptr;  // null: nothing is kept any more
};

/// The glove of a session: the samples that the controller gets, and their times. Of the control
/// thread between StartTime_ns() and End().
class LiveGlove {
 public:
  virtual ~LiveGlove() = default;

  /// Waits for the first sample. False if the glove ends, or the program is to stop, before it.
  virtual bool WaitForFirst() = 0;
  /// Angles of the channels at the first sample.
  virtual std::vector<double> FirstAngles_rad() const = 0;
  /// When the first tick is to be, not before `soon_ns`, by CLOCK_MONOTONIC.
  virtual std::int64_t StartTime_ns(std::int64_t soon_ns) const = 0;

  /// The controller's half of a tick: the command frame of the loop, or an empty one.
  std::span<const std::int32_t> StepController(const LiveTick& tick, HandLoop& loop) noexcept;
  /// Since when the controller has its sample.
  const SampleTimes& sample() const noexcept { return sample_; }
  /// No sample follows from this tick on.
  virtual bool HasEnded(std::int64_t tick) const noexcept = 0;
  /// Frames that have arrived and wait for a tick.
  virtual std::int64_t waiting_frames() const noexcept { return 0; }

  /// After the last tick, and without a first sample. Errors: UserError for frames that are not
  /// those of the glove, and if there were none; Cancelled.
  virtual void End(LiveResult& /*result*/) {}

 private:
  /// The step of the loop.
  virtual std::span<const std::int32_t> Step(const LiveTick& tick, HandLoop& loop) noexcept = 0;
  /// The times of the sample that the controller has, if it is another than `before`.
  virtual std::optional<SampleTimes> TimesOf(const LiveTick& tick, const HandLoop& loop,
                                             std::int64_t before) const noexcept = 0;

  SampleTimes sample_;
};

/// The simulated glove of `setup`, or the frames of its source. `setup` lives longer.
std::unique_ptr<LiveGlove> MakeLiveGlove(const LiveSetup& setup);

}  // namespace gauntlet::sim
