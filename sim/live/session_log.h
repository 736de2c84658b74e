#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <thread>
#include <vector>

#include "sim/live/live_session.h"
#include "sim/live/row_ring.h"
#include "sim/loop/hand_loop.h"
#include "sim/trial/trace_recorder.h"

namespace gauntlet::sim {

/// What is kept of a session: the trace, the samples of a real glove, and the targets of the
/// shadows. The control thread adds rows; a thread of the log moves them to memory that grows.
class SessionLog {
 public:
  /// The rows go into `result`, which has its shadows. Errors: RunError if no thread starts.
  SessionLog(const LiveSetup& setup, LiveResult& result);

  // Of the control thread.
  void AddTick(const HandLoop& loop) noexcept { recorder_.Record(loop); }
  /// Time since the first tick.
  void AddSample(double time_s, std::span<const double> counts) noexcept {
    samples_.Push(time_s, counts);
  }
  /// Shape: shadows x joints. Units: rad. Ticks grow.
  void AddTargets(std::int64_t tick, std::span<const double> targets_rad) noexcept {
    targets_.Push(tick, targets_rad);
  }

  /// After the last row.
  void End();

 private:
  void Move();
  void MoveTargets(std::size_t tick, std::span<const double> targets_rad);
  void SortTargets();

  LiveResult& result_;
  TraceRecorder recorder_;
  RowRing<double> samples_;        // time [s] and counts
  RowRing<std::int64_t> targets_;  // tick; shadows x joints
  std::vector<double> moved_targets_;
  std::vector<double> last_targets_;
  std::size_t most_targets_;
  std::jthread thread_;  // last: it ends before what it uses
};

}  // namespace gauntlet::sim
