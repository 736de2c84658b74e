#pragma once

#include <cstddef>
#include <span>
#include <thread>
#include <vector>

#include "sim/live/live_session.h"
#include "sim/live/row_ring.h"
#include "sim/trial/loop/hand_loop.h"
#include "sim/trial/trace_recorder.h"

namespace gauntlet::sim {

/// Memory of a session: the trace, the samples of a real glove, and the targets of the shadows. The
/// control thread adds rows; a thread of the log moves them to memory that grows.
class SessionLog {
 public:
  /// The rows go into `result`, which has its shadows. Errors: RunError if no thread starts.
  SessionLog(const LiveSetup& setup, LiveResult& result);

  // The control thread has these.
  void AddTick(const HandLoop& loop) noexcept { recorder_.Record(loop); }
  /// Time since the first tick.
  void AddSample(double time_s, std::span<const double> counts) noexcept {
    samples_.Push(time_s, counts);
  }
  /// A row per tick. Shape: shadows x joints. Units: rad.
  void AddTargets(std::span<const double> targets_rad) noexcept { targets_.Push(0, targets_rad); }

  /// After the last row.
  void End();

 private:
  void Move();
  void SortTargets();

  RowRing<double> samples_;  // time [s] and counts
  RowRing<int> targets_;     // 0; shadows x joints
  LiveResult& result_;
  std::size_t most_targets_;
  std::vector<double> moved_targets_;
  TraceRecorder recorder_;
  std::jthread thread_;  // last: it ends before what it uses
};

}  // namespace gauntlet::sim
