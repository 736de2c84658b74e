#pragma once

#include "sim/base/signal_storage.h"

namespace gauntlet::test {

/// Every signal lies on the disk, and leaves the memory whenever it may.
inline sim::SignalStorageLimits AllOnDisk() {
  sim::SignalStorageLimits limits;
  limits.counted_from_bytes = 1;
  limits.longest_on_heap_bytes = 0;
  limits.resident_bytes = 0;
  return limits;
}

/// Other limits until the end of the scope.
class SignalLimits {
 public:
  explicit SignalLimits(const sim::SignalStorageLimits& limits) {
    sim::SetSignalStorageLimits(limits);
  }
  ~SignalLimits() { sim::SetSignalStorageLimits(before_); }
  SignalLimits(const SignalLimits&) = delete;
  SignalLimits& operator=(const SignalLimits&) = delete;

 private:
  sim::SignalStorageLimits before_ = sim::GetSignalStorageLimits();
};

}  // namespace gauntlet::test
