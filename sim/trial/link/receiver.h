#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "controller/timing.h"
#include "sim/trial/link/frame_pool.h"
#include "sim/trial/link/link_config.h"

namespace gauntlet::sim {

/// Decides which of the frames that have arrived is used at a tick. It owns no clock: a trial
/// passes simulated arrivals, a real loop those of its sockets. With the stamp of a frame:
///
///     relative delay  d = arrival - stamp - base,   base = min(arrival - stamp) over the window
///     due             stamp + base + D,             D = 0, the buffer, or a quantile of d
///
/// So no common clock is needed. While nothing newer is due, the last frame is held, or its slope
/// is extrapolated over the time by which the next one is overdue, in whole periods.
///
/// Shapes: `values` per frame. Units: ticks. Neither Accept() nor Step() throws or allocates.
class Receiver {
 public:
  /// Result of Step().
  enum class Found { kNothing, kNew, kHeld, kPredicted };

  Receiver(const ReceiverConfig& config, int values, double period_ticks,
           const controller::Timing& timing);

  /// A frame that arrives at this tick; its values are copied.
  void Accept(std::int64_t tick, const LinkFrame& frame) noexcept;
  /// Finds the values used at this tick; kNothing before the first frame. Ticks grow.
  Found Step(std::int64_t tick) noexcept;

  /// After Step(). Before the first frame: zeros.
  std::span<const double> values() const noexcept { return shown_; }
  /// Origin tick of the frame that is used, or whose slope is extrapolated.
  std::int64_t origin_tick() const noexcept { return used_.origin_tick; }
  /// Its number; -1 before the first.
  std::int64_t number() const noexcept { return used_.number; }
  /// Frames that wait for their time.
  std::size_t waiting_frames() const noexcept { return waiting_.size(); }

  /// Length of the buffer now.
  double buffer_ticks() const noexcept { return buffer_ticks_; }
  /// Frames that arrived, and those of them that arrived after they were due.
  std::int64_t arrived_frames() const noexcept { return arrived_frames_; }
  std::int64_t late_frames() const noexcept { return late_frames_; }

  void Reset();

 private:
  static constexpr std::size_t kWindowParts = 10;

  bool is_queue() const noexcept { return std::holds_alternative<QueueReceiver>(settings_); }
  void Measure(std::int64_t tick, double transit_ticks) noexcept;
  void AdaptBuffer(double relative_ticks) noexcept;
  void Remember(const LinkFrame& frame) noexcept;
  void Keep(const LinkFrame& frame) noexcept;
  void DropFirst(std::size_t count) noexcept;
  bool UseDue(std::int64_t tick) noexcept;
  void Use(std::int64_t tick, int place) noexcept;
  double OverdueTicks(std::int64_t tick) const noexcept;
  void FindSlopes() noexcept;

  ReceiverSettings settings_;
  GapConfig gap_;
  double period_ticks_;
  controller::Timing timing_;
  std::size_t most_waiting_;

  double base_ticks_ = 0.0;
  std::array<double, kWindowParts> least_transit_ticks_{};  // in each part of the window
  std::array<std::int64_t, kWindowParts> part_number_{};
  double part_ticks_ = 0.0;

  double buffer_ticks_ = 0.0;
  double forget_ = 1.0;               // weight of a frame over that of the next
  double weight_ = 1.0;               // of the next frame
  std::vector<double> delay_shares_;  // weights of relative delays, in buckets of 1 ms

  FramePool pool_;
  std::vector<int> waiting_;  // places: in the order of arrival (queue), or of their numbers
  double next_use_tick_ = 0.0;

  // The last frames that arrived, for slopes; a ring.
  std::size_t history_size_ = 0;
  std::vector<double> history_values_;
  std::vector<double> history_stamps_;
  std::int64_t remembered_ = 0;
  std::int64_t remembered_number_ = -1;
  bool slopes_are_known_ = false;
  std::vector<double> slope_;  // per value and tick

  LinkFrame used_;
  std::vector<double> used_values_;
  std::int64_t used_tick_ = 0;
  bool has_used_ = false;
  std::vector<double> shown_;
  std::int64_t arrived_frames_ = 0;
  std::int64_t late_frames_ = 0;
};

}  // namespace gauntlet::sim
