#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace gauntlet::sim {

/// The link between controller and servos: a frame that is sent arrives `delay_ticks` later. A ring
/// of fixed size, so that the loop does not allocate.
class EventLink {
 public:
  /// `period_ticks`: the least time between two frames.
  EventLink(int delay_ticks, double period_ticks, int motors);

  /// Takes a frame at this tick; at most one per tick, and ticks grow.
  void Send(std::int64_t tick, std::span<const std::int32_t> motor_counts) noexcept;
  /// The frame that arrives at this tick, or an empty one. Asked at every tick.
  std::span<const std::int32_t> Arriving(std::int64_t tick) noexcept;
  /// Forgets all frames that are on their way.
  void Reset() noexcept { received_ = sent_ = 0; }

 private:
  struct Frame {
    std::int64_t arrival_tick = 0;
    std::vector<std::int32_t> motor_counts;
  };

  int delay_ticks_;
  std::vector<Frame> ring_;
  std::size_t sent_ = 0;
  std::size_t received_ = 0;
};

}  // namespace gauntlet::sim
