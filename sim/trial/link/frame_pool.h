#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace gauntlet::sim {

/// Frame on a link. Times are ticks of the loop.
struct LinkFrame {
  std::int64_t number = 0;       // counted by the sender
  std::int64_t origin_tick = 0;  // capture of the glove sample behind it; for scores alone
  double stamp_ticks = 0.0;      // when it was sent, by the sender's clock
  std::span<const double> values = {};
};

/// Frames in memory of a fixed size, so that a loop with a link does not allocate.
class FramePool {
 public:
  FramePool(std::size_t frames, int values)
      : width_(static_cast<std::size_t>(values)), frames_(frames), values_(frames * width_) {
    Reset();
  }

  /// Keeps a copy at a free place. Without one: nothing, -1.
  int Keep(const LinkFrame& frame) noexcept {
    if (free_.empty()) return -1;
    const int place = free_.back();
    free_.pop_back();
    LinkFrame& kept = frames_[static_cast<std::size_t>(place)];
    const std::span<double> copy =
        std::span(values_).subspan(static_cast<std::size_t>(place) * width_, width_);
    for (std::size_t i = 0; i < width_; ++i) copy[i] = frame.values[i];
    kept = frame;
    kept.values = copy;
    return place;
  }
  const LinkFrame& At(int place) const noexcept { return frames_[static_cast<std::size_t>(place)]; }
  void Release(int place) noexcept { free_.push_back(place); }
  void Reset() {
    free_.resize(frames_.size());
    for (std::size_t i = 0; i < free_.size(); ++i) {
      free_[i] = static_cast<int>(free_.size() - 1 - i);
    }
  }

 private:
  std::size_t width_;
  std::vector<LinkFrame> frames_;
  std::vector<double> values_;
  std::vector<int> free_;  // places; the last is the next
};

}  // namespace gauntlet::sim
