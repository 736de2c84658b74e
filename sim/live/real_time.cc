#include "sim/live/real_time.h"

#include <pthread.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/prctl.h>

#include <array>
#include <cerrno>
#include <cmath>
#include <cstddef>
#include <ctime>

#include "sim/live/device/device_clock.h"

namespace gauntlet::sim {
namespace {

void TouchStack() noexcept {
  constexpr std::size_t kBytes = std::size_t{512} << 10;
  constexpr std::size_t kPage = 4096;
  std::array<volatile char, kBytes> stack;
  for (std::size_t at = 0; at < kBytes; at += kPage) stack[at] = 0;
}

}  // namespace

std::string RealTimeRights::Refusal() const {
  if (has_priority && has_locked_memory) return "";
  const char* const what = has_priority        ? "locked memory is"
                           : has_locked_memory ? "real-time priority is"
                                               : "real-time priority and locked memory are";
  return std::string(what) +
         " not allowed: wake-ups may be late; to allow it, add the lines \"@USER - rtprio 99\" and "
         "\"@USER - memlock unlimited\" with your group to /etc/security/limits.d/gauntlet.conf "
         "and "
         "log in again";
}

bool RaisePriority(int priority) noexcept {
  TouchStack();
  prctl(PR_SET_TIMERSLACK, 1UL);
  const sched_param parameters{.sched_priority = priority};
  return pthread_setschedparam(pthread_self(), SCHED_FIFO, &parameters) == 0;
}

bool LockMemory() noexcept { return mlockall(MCL_CURRENT) == 0; }
void UnlockMemory() noexcept { munlockall(); }

PeriodicWake::PeriodicWake(std::int64_t start_ns, double rate_hz) noexcept
    : start_ns_(start_ns), period_ns_(1e9 / rate_hz) {}

std::int64_t PeriodicWake::NominalOf_ns(std::int64_t period) const noexcept {
  return start_ns_ + std::llround(static_cast<double>(period) * period_ns_);
}

PeriodicWake::Woken PeriodicWake::Wait() noexcept {
  Woken woken;
  const auto behind_ns = static_cast<double>(MonotonicNow_ns() - NominalOf_ns(next_));
  if (behind_ns > period_ns_) woken.skipped = std::llround(std::floor(behind_ns / period_ns_));
  next_ += woken.skipped;
  woken.nominal_ns = NominalOf_ns(next_++);
  const std::timespec until{
      .tv_sec = static_cast<std::time_t>(woken.nominal_ns / kNanosecondsPerSecond),
      .tv_nsec = static_cast<long>(woken.nominal_ns % kNanosecondsPerSecond)};
  while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &until, nullptr) == EINTR) {
  }
  woken.lateness_ns = MonotonicNow_ns() - woken.nominal_ns;
  return woken;
}

}  // namespace gauntlet::sim
