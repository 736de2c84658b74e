#pragma once

#include <cstdint>

namespace gauntlet::sim {

/// Lets the grid of samples follow a real glove so that `kInTime` of the frames arrive before the
/// tick that uses them: the Robbins-Monro search of a quantile.
class GridFollower {
 public:
  explicit GridFollower(int ticks_per_sample) : period_(ticks_per_sample) {}

  /// A frame arrived `wait_ticks` before the next sample, 0 to the period - 1. Returns by how much
  /// the grid is to be shifted.
  int Step(std::int64_t wait_ticks) noexcept {
    constexpr double kInTime = 0.95;
    constexpr int kCoarse = 4;
    if (period_ < kCoarse) return 0;
    if (wait_ticks == 0) return 0;
    const bool is_late = 2 * wait_ticks > period_;
    phase_ += is_late ? kInTime : kInTime - 1.0;
    const int shift = phase_ >= 1.0 ? 1 : phase_ <= -1.0 ? -1 : 0;
    phase_ -= shift;
    return shift;
  }

 private:
  int period_;
  double phase_ = 0.0;
};

}  // namespace gauntlet::sim
