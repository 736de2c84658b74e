#pragma once

#include <atomic>

#include "sim/base/error.h"

namespace gauntlet::sim {

/// The signal that asked the program to stop; 0: none. Only a program with signal handlers sets it.
inline std::atomic<int> stop_signal{0};

inline bool StopAsked() { return stop_signal.load(std::memory_order_relaxed) != 0; }

/// Check for long work, several times per second. It costs almost nothing.
/// Errors: Cancelled if the program was asked to stop.
inline void ThrowIfStopped() {
  if (StopAsked()) throw Cancelled{};
}

/// Marks a short change of files that must be completed, also after a second Ctrl-C.
class Unbroken {
 public:
  Unbroken() { ++count; }
  ~Unbroken() { --count; }
  Unbroken(const Unbroken&) = delete;
  Unbroken& operator=(const Unbroken&) = delete;

  static bool Any() { return count > 0; }

 private:
  static inline std::atomic<int> count{0};
};

}  // namespace gauntlet::sim
