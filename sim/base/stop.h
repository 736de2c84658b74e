#pragma once

#include <atomic>

#include "sim/base/error.h"

namespace gauntlet::sim {

/// The signal that asked the program to stop; 0: none did. Only a program that handles signals sets
/// it.
inline std::atomic<int> stop_signal{0};

inline bool StopAsked() { return stop_signal.load(std::memory_order_relaxed) != 0; }

/// Long work asks several times per second; a question costs next to nothing.
/// Errors: Cancelled if the program was asked to stop.
inline void ThrowIfStopped() {
  if (StopAsked()) throw Cancelled{};
}

/// While there is one, the program is in the middle of a change of files that takes a moment: even
/// a second Ctrl-C lets it get to its end.
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
