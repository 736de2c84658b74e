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
  bool is_ending = false;             // real motors turn to their rest positions
  Watchdog::Tier tier = Watchdog::Tier::kFollow;
  double silent_s = 0.0;  // since the last sample arrived
  bool has_sink = true;   // false: the motors do not listen
};

/// A tick of a running session, for running scores.
struct ShownTick {
  std::int64_t number = 0;  // as of the trace; ticks that were skipped are missing
  int driving = 0;          // number of the controller, as in LiveView::Ask()
  bool has_sample = false;  // a new one
};

/// Running scores of one controller, see session_scores.h; NaN for a score without a value.
struct RunningScore {
  double over_s = 0.0;  // the time that they are of
  double jitter_rms_deg = 0.0;
  double delay_ms = 0.0;
};

/// A running session for one other thread, which watches it, may ask for another controller and may
/// mark when the hand is still; and for a further one, which computes running scores for it. The
/// threads of the session neither wait, lock nor allocate for them: without a watcher, and with one
/// that is too slow, rows are left out.
class LiveView {
 public:
  static constexpr double kRate_hz = 50.0;
  static constexpr std::size_t kStageRows = 7;
  static constexpr std::size_t kNumbersOfScore = 3;

  LiveView(std::size_t channels, std::size_t joints, std::size_t controllers, double tick_rate_hz)
      : moments_(64, channels + (2 + controllers) * joints),
        ticks_(static_cast<std::size_t>(2.0 * tick_rate_hz), channels + (1 + controllers) * joints),
        scores_(8, kNumbersOfScore * controllers),
        row_(moments_.width()),
        score_row_(scores_.width()),
        channels_(channels),
        joints_(joints),
        controllers_(controllers) {}

  std::size_t channels() const noexcept { return channels_; }
  std::size_t joints() const noexcept { return joints_; }
  std::size_t controllers() const noexcept { return controllers_; }

  /// Called by the control thread. Shapes: glove, a value per channel; command and hand, one per
  /// joint; asked, what each controller asks of the joints by itself, controllers x joints.
  /// Units: rad.
  void Show(const LiveMoment& moment, std::span<const double> glove_rad,
            std::span<const double> command_rad, std::span<const double> hand_rad,
            std::span<const double> asked_rad) noexcept {
    moments_.Push(moment, Joined(glove_rad, command_rad, hand_rad, asked_rad));
  }
  /// Called by the control thread, with a tick: values as above, without the hand's.
  void ShowTick(const ShownTick& tick, std::span<const double> glove_rad,
                std::span<const double> command_rad, std::span<const double> asked_rad) noexcept {
    ticks_.Push(tick, Joined(glove_rad, command_rad, {}, asked_rad));
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
  /// Called by the thread of the running scores, as above: use(tick, values) for the oldest tick;
  /// and the scores of all controllers, at the time of a tick.
  template <class Use>
  bool NextTick(const Use& use) {
    return ticks_.Pop(use);
  }
  void ShowScores(double time_s, std::span<const RunningScore> scores) noexcept {
    GAUNTLET_ASSERT(scores.size() == controllers_);
    auto place = score_row_.begin();
    for (const RunningScore& score : scores) {
      for (const double number : {score.over_s, score.jitter_rms_deg, score.delay_ms}) {
        *place++ = number;
      }
    }
    scores_.Push(time_s, score_row_);
  }
  /// Called by the watcher, for running scores: use(time_s, numbers), kNumbersOfScore for each
  /// controller in the order of RunningScore.
  template <class Use>
  bool NextScores(const Use& use) {
    return scores_.Pop(use);
  }
  /// As Next(), for stages: use(stages_us).
  template <class Use>
  bool NextStages(const Use& use) {
    return stages_.Pop([&](int, std::span<const double> stages_us) { use(stages_us); });
  }

 private:
  /// These values, one behind the other; of the control thread.
  std::span<const double> Joined(std::span<const double> glove_rad,
                                 std::span<const double> command_rad,
                                 std::span<const double> hand_rad,
                                 std::span<const double> asked_rad) noexcept {
    GAUNTLET_ASSERT(glove_rad.size() == channels_ && command_rad.size() == joints_ &&
                    (hand_rad.empty() || hand_rad.size() == joints_) &&
                    asked_rad.size() == controllers_ * joints_);
    auto place = row_.begin();
    for (const std::span<const double> values : {glove_rad, command_rad, hand_rad, asked_rad}) {
      place = std::ranges::copy(values, place).out;
    }
    return std::span(row_).first(static_cast<std::size_t>(place - row_.begin()));
  }

  RowRing<LiveMoment> moments_;
  RowRing<int> stages_{256, kStageRows};
  RowRing<ShownTick> ticks_;       // of two seconds
  RowRing<double> scores_;         // time [s]
  std::vector<double> row_;        // of the control thread
  std::vector<double> score_row_;  // of the thread of the scores
  std::size_t channels_;
  std::size_t joints_;
  std::size_t controllers_;
  std::atomic<int> asked_ = -1;
  std::atomic<int> mark_ = -1;
};

}  // namespace gauntlet::sim
