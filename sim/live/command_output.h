#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <span>
#include <thread>

#include "sim/live/device/frame_sink.h"
#include "sim/live/live_session.h"
#include "sim/live/live_view.h"
#include "sim/live/row_ring.h"
#include "sim/live/stage_clock.h"

namespace gauntlet::sim {

/// Commands on their way to real motors, sent by a thread of its own: of several that wait the
/// newest, since an old command is of no use. Without real motors there is no such thread, and a
/// command counts as sent when it is due.
class CommandOutput {
 public:
  /// `sink`: null without real motors.
  CommandOutput(FrameSink* sink, std::size_t motors, LiveView* view);
  ~CommandOutput() { End(); }
  CommandOutput(const CommandOutput&) = delete;
  CommandOutput& operator=(const CommandOutput&) = delete;

  bool has_motors() const noexcept { return sink_ != nullptr; }

  /// Errors: RunError if no thread starts.
  void Begin();
  /// Sends a command, called by the control thread. Units: counts.
  void Send(const OutputHead& head, std::span<const double> counts) noexcept;
  /// The motors do not listen.
  bool is_gone() const noexcept { return is_gone_.load(std::memory_order_relaxed); }
  /// Waits until the last command is sent.
  void End() noexcept;

  /// After End().
  void AddFacts(LiveFacts& facts) const;

 private:
  void SendAll();
  void SendNewest(const OutputHead& head, std::span<const double> counts);
  void Wake() noexcept;

  RowRing<OutputHead> commands_;
  FrameSink* sink_;
  // Members of the thread.
  StageClock clock_;  // without motors, of the control thread
  std::int64_t replaced_ = 0;
  int good_sends_ = 0;
  // Members of both threads.
  std::atomic<std::uint32_t> calls_ = 0;
  std::atomic<bool> ends_ = false;
  std::atomic<bool> is_gone_ = false;
  std::jthread thread_;  // last: it ends before what it uses
};

}  // namespace gauntlet::sim
