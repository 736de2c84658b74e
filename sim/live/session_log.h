#pragma once

#include <atomic>
#include <cstdint>
#include <span>
#include <thread>

#include "sim/live/live_session.h"
#include "sim/live/row_ring.h"
#include "sim/live/session_recording.h"
#include "sim/trial/loop/hand_loop.h"
#include "sim/trial/trace_recorder.h"

namespace gauntlet::sim {

/// Ways out of the control thread: the trace and the targets of the shadows, which a thread of the
/// log moves to their memory, all allocated before; the samples and what the watcher did, which
/// another thread brings to the recording. That one may wait for a disk.
class SessionLog {
 public:
  /// The rows go into `result`, which has its shadows. Errors: RunError if no thread starts.
  SessionLog(const LiveSetup& setup, LiveResult& result);

  // The control thread has these.
  void AddTick(const HandLoop& loop) noexcept { recorder_.Record(loop); }
  /// Time since the first tick.
  void AddSample(double time_s, std::span<const double> counts) noexcept {
    if (recording_ != nullptr && !samples_.Push(time_s, counts)) {
      lost_samples_.fetch_add(1, std::memory_order_relaxed);
    }
  }
  /// Another controller drives since then, or the hand is marked still, or moves again.
  struct Note {
    enum class Kind : std::uint8_t { kDrives, kStill, kMoves } kind = Kind::kDrives;
    double time_s = 0.0;
    int controller = 0;  // as in LiveView::Ask()
  };
  void AddNote(const Note& note) noexcept {
    if (recording_ != nullptr) notes_.Push(note, {});
  }
  /// A row per tick. Shape: shadows x joints. Units: rad.
  void AddTargets(std::span<const double> targets_rad) noexcept { targets_.Push(0, targets_rad); }

  /// After the last row.
  void End();

 private:
  void Move();
  void Record();

  RowRing<double> samples_;  // time [s] and counts
  RowRing<Note> notes_;
  RowRing<int> targets_;  // 0; shadows x joints
  SessionRecording* recording_;
  const LiveSetup& setup_;
  std::atomic<std::int64_t> lost_samples_ = 0;
  LiveResult& result_;
  Eigen::Index moved_targets_ = 0;  // ticks
  TraceRecorder recorder_;
  std::jthread recording_thread_;  // last: they end before what they use
  std::jthread thread_;
};

}  // namespace gauntlet::sim
