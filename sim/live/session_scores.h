#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <thread>
#include <vector>

#include "controller/joint_map.h"
#include "sim/glove/glove.h"
#include "sim/live/live_view.h"
#include "sim/live/target_scores.h"

namespace gauntlet::sim {

/// How the ticks of a session are scored while it runs.
struct RunningScoring {
  TargetScoring scoring;
  std::vector<double> earliest_delay_s;  // of each controller
  controller::JointMap joint_map;
  /// Reference: its true angles. Null: the samples of the glove, joined by lines and smoothed
  /// without delay, as a recording is behind the session.
  std::shared_ptr<const GloveSignal> simulated_glove;
  std::optional<std::vector<CountedTicks>> counted = {};  // of each joint that counts; none: all
  double smoothing_hz = 5.0;
  double longest_gap_s = 0.1;  // between samples; behind a longer one nothing counts for so long:
  double recovery_s = ScoreConfig{}.recovery_s;
};

/// The last ten seconds of a session, and the scores of its controllers over them: those of
/// gauntlet run, see ScoreTargets(), of the angles that each controller asks of the joints. The one
/// that drives is scored by what it drove, since it took over. Controllers that are scored over the
/// same time have means over the same joints.
class ScoreWindow {
 public:
  static constexpr double kLength_s = 10.0;
  /// A delay is searched over lags of up to 1 s, and up to a quarter of the signal.
  static constexpr double kLeastDelay_s = 4.0;

  explicit ScoreWindow(RunningScoring how);

  /// Scores a whole window once, so that none takes more memory later. It is empty then.
  void TakeMemory();
  /// Values: as of LiveView::ShowTick(). Ticks that were skipped repeat the one before, as in a
  /// trace; behind a gap of more than 0.1 s, and where the ticks begin anew, all begins anew.
  void Add(const ShownTick& tick, std::span<const double> values_rad);

  double time_s() const { return static_cast<double>(end_) / how_.scoring.rate_hz; }
  /// One for each controller. Allocates.
  std::vector<RunningScore> Scores() const;

 private:
  std::int64_t begin() const { return end_ - std::min<std::int64_t>(end_ - first_, capacity_); }
  std::span<double> RowOf(std::int64_t tick);
  Signal ValueFrom(Eigen::Index first, std::size_t value) const;
  Signal Reference(int joint, const CountedTicks& with_samples) const;
  CountedTicks WithSamples() const;
  CountedTicks Counted(std::size_t place, const CountedTicks& with_samples) const;
  void ScoreFrom(Eigen::Index first, std::span<const std::size_t> controllers,
                 std::vector<RunningScore>& running) const;

  RunningScoring how_;
  std::size_t channels_;
  std::size_t joints_;
  std::int64_t capacity_;
  std::vector<double> values_rad_;  // of tick n at n % capacity, one row behind the other
  std::vector<bool> has_sample_;
  std::int64_t first_ = 0;  // tick
  std::int64_t end_ = 0;    // one behind the last
  int driving_ = 0;
  std::int64_t driving_since_ = 0;
};

/// Computes running scores of a session twice a second, for its watcher, in a thread of its own
/// with low priority, until it is destroyed.
class SessionScores {
 public:
  /// Keeps `view`. Errors: RunError if no thread starts.
  SessionScores(RunningScoring how, LiveView& view);

 private:
  std::jthread thread_;
};

}  // namespace gauntlet::sim
