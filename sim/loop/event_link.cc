#include "sim/loop/event_link.h"

#include <algorithm>
#include <cmath>

#include "controller/assert.h"

namespace gauntlet::sim {

EventLink::EventLink(int delay_ticks, double period_ticks, int motors)
    : delay_ticks_(delay_ticks),
      ring_(static_cast<std::size_t>(delay_ticks / std::max(1.0, std::floor(period_ticks))) + 2) {
  GAUNTLET_ASSERT(delay_ticks >= 0 && motors > 0);
  for (Frame& frame : ring_) frame.motor_counts.resize(static_cast<std::size_t>(motors));
}

void EventLink::Send(std::int64_t tick, std::span<const std::int32_t> motor_counts) noexcept {
  GAUNTLET_ASSERT(sent_ - received_ < ring_.size());
  GAUNTLET_ASSERT(motor_counts.size() == ring_.front().motor_counts.size());
  Frame& frame = ring_[sent_++ % ring_.size()];
  frame.arrival_tick = tick + delay_ticks_;
  std::copy(motor_counts.begin(), motor_counts.end(), frame.motor_counts.begin());
}

std::span<const std::int32_t> EventLink::Arriving(std::int64_t tick) noexcept {
  if (received_ == sent_) return {};
  const Frame& frame = ring_[received_ % ring_.size()];
  if (frame.arrival_tick != tick) return {};
  ++received_;
  return frame.motor_counts;
}

}  // namespace gauntlet::sim
