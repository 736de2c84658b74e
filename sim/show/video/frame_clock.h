#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

namespace gauntlet::sim {

/// Part of a motion that a video shows, and its speed.
struct Excerpt {
  double from_s = 0.0;
  double to_s = std::numeric_limits<double>::infinity();  // at most to the end of the motion
  double speed = 1.0;  // 0.25 is slow motion; three decimals count

  /// The whole motion, however fast.
  bool is_all() const { return from_s == 0.0 && std::isinf(to_s); }
};

/// A part of a video that shows motion: from `video_s` on the motion from `from_s` to `to_s`.
struct VideoStretch {
  double video_s = 0.0;
  double from_s = 0.0;
  double to_s = 0.0;
  double speed = 1.0;
};

/// Which sample a frame shows. Whole numbers only: frame k never drifts, however long the video.
///
///     sample = first + floor(frame rate speed / frames_per_s),
///     the rate as a whole number of millihertz, the speed as one of thousandths
struct FrameClock {
  std::int64_t rate_millihertz;
  std::int64_t frames_per_s;
  std::int64_t speed_thousandths;
  std::int64_t first;  // sample
  std::int64_t end;    // the one after the last

  FrameClock(double rate_hz, int given_frames_per_s, std::int64_t sample_count,
             const Excerpt& excerpt = {})
      : rate_millihertz(std::llround(rate_hz * 1000.0)),
        frames_per_s(given_frames_per_s),
        speed_thousandths(std::llround(excerpt.speed * 1000.0)),
        first(SampleAt(excerpt.from_s, sample_count)),
        end(SampleAt(excerpt.to_s, sample_count)) {}

  int Sample(int frame) const {
    return static_cast<int>(first + frame * rate_millihertz * speed_thousandths /
                                        (1'000'000 * frames_per_s));
  }
  /// Every frame that has a sample.
  int FrameCount() const { return FirstFrameFrom(end); }
  /// The first frame that shows `sample` or a later one, of those that there are and one more.
  int FirstFrameFrom(std::int64_t sample) const {
    const std::int64_t per_frame = rate_millihertz * speed_thousandths;
    const std::int64_t shown = std::clamp(sample, first, std::max(first, end)) - first;
    return static_cast<int>((shown * 1'000'000 * frames_per_s + per_frame - 1) / per_frame);
  }
  double rate_hz() const { return static_cast<double>(rate_millihertz) / 1000.0; }
  double speed() const { return static_cast<double>(speed_thousandths) / 1000.0; }
  double first_s() const { return static_cast<double>(first) / rate_hz(); }
  double Time_s(int frame) const { return first_s() + frame * speed() / frames_per_s; }

 private:
  std::int64_t SampleAt(double time_s, std::int64_t sample_count) const {
    const double sample = std::round(time_s * rate_hz());
    return sample < static_cast<double>(sample_count) ? static_cast<std::int64_t>(sample)
                                                      : sample_count;
  }
};

}  // namespace gauntlet::sim
