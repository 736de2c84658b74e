#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "controller/assert.h"
#include "sim/live/row_ring.h"
#include "sim/trial/link/watchdog.h"

namespace gauntlet::sim {

/// State of a running session, as a person watches it.
struct LiveMoment {
  double time_s = 0.0;              // since the first sample
  double largest_lateness_s = 0.0;  // of wake-ups since the moment before
  std::int64_t skipped_ticks = 0;
  std::int64_t waiting_frames = 0;    // before the control thread
  std::int64_t queued_frames = 0;     // in the receiver
  std::int64_t commands = 0;          // frames sent
  std::int64_t repeated_samples = 0;  // commands with the sample of the one before
  int driving = 0;                    // number of the controller, as in LiveView::Ask()
  bool is_still = false;              // as marked
  Watchdog::Tier tier = Watchdog::Tier::kFollow;
  bool has_sink = true;  // false: the motors do not listen
};

/// A running session for one other thread, which watches it, may ask for another controller and may
/// mark when the hand is still. The threads of the session neither wait, lock nor allocate for it:
/// without a watcher, and with one that is too slow, rows are left out.
class LiveView {
 public:
  static constexpr double kRate_hz = 50.0;
  static constexpr std::size_t kStageRows = 7;

  LiveView(std::size_t channels, std::size_t joints)
      : moments_(64, channels + 2 * joints),
        row_(channels + 2 * joints),
        channels_(channels),
        joints_(joints) {}

  std::size_t channels() const noexcept { return channels_; }
  std::size_t joints() const noexcept { return joints_; }

  /// Called by the control thread. Shapes: glove, a value per channel; the others, one per joint.
  /// Units: rad.
  void Show(const LiveMoment& moment, std::span<const double> glove_rad,
            std::span<const double> command_rad, std::span<const double> hand_rad) noexcept {
    GAUNTLET_ASSERT(glove_rad.size() == channels_ && command_rad.size() == joints_ &&
                    hand_rad.size() == joints_);
    auto place = std::ranges::copy(glove_rad, row_.begin()).out;
    place = std::ranges::copy(command_rad, place).out;
    std::ranges::copy(hand_rad, place);
    moments_.Push(moment, row_);
  }
  /// Called by the thread that sends commands: the stages of one, as in stage_clock.h [us].
  void ShowStages(std::span<const double> stages_us) noexcept { stages_.Push(0, stages_us); }
  /// Number of the controller that is asked for since the last call, or -1.
  int TakeAsked() noexcept { return asked_.exchange(-1, std::memory_order_acq_rel); }
  /// 1: the hand is marked still since the last call, 0: it moves again, -1: nothing new.
  int TakeMark() noexcept { return mark_.exchange(-1, std::memory_order_acq_rel); }

  /// Called by the watcher: asks for a controller, 0 for the first that drove, then the shadows in
  /// order. The last wish counts.
  void Ask(int controller) noexcept { asked_.store(controller, std::memory_order_release); }
  /// Called by the watcher: the hand is still from now on, or moves. The last mark counts.
  void Mark(bool is_still) noexcept { mark_.store(is_still ? 1 : 0, std::memory_order_release); }
  /// Calls use(moment, values) for the oldest moment, if there is one. The values are those of
  /// Show(), one behind the other.
  template <class Use>
  bool Next(const Use& use) {
    return moments_.Pop(use);
  }
  /// As the function above, for stages: use(stages_us).
  template <class Use>
  bool NextStages(const Use& use) {
    return stages_.Pop([&](int, std::span<const double> stages_us) { use(stages_us); });
  }

 private:
  RowRing<LiveMoment> moments_;
  RowRing<int> stages_{256, kStageRows};
  std::vector<double> row_;  // of the control thread
  std::size_t channels_;
  std::size_t joints_;
  std::atomic<int> asked_ = -1;
  std::atomic<int> mark_ = -1;
};

}  // namespace gauntlet::sim
