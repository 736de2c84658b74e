#pragma once

#include <cstdint>
#include <memory>
#include <optional>

#include "sim/base/timing.h"
#include "sim/glove/glove.h"
#include "sim/live/device/frame_sink.h"
#include "sim/live/duration_histogram.h"
#include "sim/live/real_time.h"
#include "sim/trial/link/link_config.h"

namespace gauntlet::sim {

/// A simulated glove that sends its samples as a device would.
struct GlovePlay {
  std::shared_ptr<const GloveSignal> glove;
  std::optional<LinkConfig> link = {};  // delays, losses and the clock of the frames; none: none
  controller::Timing timing;            // of the ticks in which frames arrive
  std::uint64_t seed = 0;               // of the link
  double seconds = 0.0;                 // 0: the length of the motion; longer: it repeats
};

/// Frames that were sent.
struct GlovePlayed {
  std::int64_t samples = 0;
  std::int64_t lost = 0;     // on the simulated link
  std::int64_t failed = 0;   // frames that found no receiver
  std::int64_t dropped = 0;  // frames for which the system had no room
  std::int64_t skipped_ticks = 0;
  double duration_s = 0.0;
  DurationHistogram lateness;  // of wake-ups
};

/// Plays the glove in real time, until its end or StopAsked(). Frames have their number and the
/// time of their capture by the glove's clock; NaN is a missing value.
GlovePlayed PlayGlove(const GlovePlay& play, FrameSink& sink);

}  // namespace gauntlet::sim
