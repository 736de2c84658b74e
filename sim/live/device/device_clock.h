#pragma once

#include <cstdint>
#include <ctime>

namespace gauntlet::sim {

inline constexpr std::int64_t kNanosecondsPerSecond = 1'000'000'000;

inline std::int64_t Nanoseconds(const std::timespec& time) {
  return std::int64_t{time.tv_sec} * kNanosecondsPerSecond + time.tv_nsec;
}

inline std::int64_t NowOf_ns(clockid_t clock) {
  std::timespec now{};
  clock_gettime(clock, &now);
  return Nanoseconds(now);
}

/// CLOCK_MONOTONIC, which counts from the start of the machine and never jumps.
inline std::int64_t MonotonicNow_ns() { return NowOf_ns(CLOCK_MONOTONIC); }

}  // namespace gauntlet::sim
