#pragma once

#include <cmath>
#include <cstdint>

namespace gauntlet::sim {

/// Which sample a frame shows. Whole numbers only: frame k never drifts, however long the video.
///
///     sample = floor(frame rate / frames_per_s), the rate as a whole number of millihertz
struct FrameClock {
  std::int64_t rate_millihertz;
  std::int64_t frames_per_s;
  std::int64_t samples;

  FrameClock(double rate_hz, int given_frames_per_s, std::int64_t sample_count)
      : rate_millihertz(std::llround(rate_hz * 1000.0)),
        frames_per_s(given_frames_per_s),
        samples(sample_count) {}

  int Sample(int frame) const { return frame * rate_millihertz / (1000 * frames_per_s); }
  /// Every frame that has a sample.
  int FrameCount() const {
    return (samples * 1000 * frames_per_s + rate_millihertz - 1) / rate_millihertz;
  }
  double Time_s(int frame) const { return static_cast<double>(frame) / frames_per_s; }
};

}  // namespace gauntlet::sim
