#pragma once

#include <cstdint>
#include <string>

namespace gauntlet::sim {

/// Rights that the system gave a thread that must be on time.
struct RealTimeRights {
  bool has_priority = false;       // SCHED_FIFO
  bool has_locked_memory = false;  // mlockall
  /// One line with what was refused, its consequence and what allows it; empty: nothing was.
  std::string Refusal() const;
};

/// Priorities of SCHED_FIFO of the threads of a session.
inline constexpr int kControlPriority = 80;
inline constexpr int kOutputPriority = 79;
inline constexpr int kInputPriority = 78;

/// Gives the calling thread the priority `priority` of SCHED_FIFO, touches the first 512 KiB of its
/// stack, and sets its timer slack to 1 ns. True if the priority was allowed.
bool RaisePriority(int priority) noexcept;
/// Keeps all memory that the program has by now in RAM. True if that was allowed.
bool LockMemory() noexcept;
void UnlockMemory() noexcept;

/// Wakes a thread at start + k / rate, k = 0, 1, .., by CLOCK_MONOTONIC. A thread that is late by
/// more than a period skips what it missed: it never hurries.
class PeriodicWake {
 public:
  struct Woken {
    std::int64_t nominal_ns = 0;   // the time that was waited for
    std::int64_t lateness_ns = 0;  // by which it was missed
    std::int64_t skipped = 0;      // periods before it that were left out
  };

  PeriodicWake(std::int64_t start_ns, double rate_hz) noexcept;

  /// Sleeps until the next period. Also returns where a signal came; the period is the same.
  Woken Wait() noexcept;
  /// Time of a period.
  std::int64_t NominalOf_ns(std::int64_t period) const noexcept;

 private:
  std::int64_t start_ns_;
  double period_ns_;
  std::int64_t next_ = 0;
};

}  // namespace gauntlet::sim
