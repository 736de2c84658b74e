#include "sim/live/real_time.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "sim/live/device/device_clock.h"

namespace gauntlet::sim {
namespace {

using testing::StartsWith;

TEST(RealTimeRights, NameWhatWasRefused) {
  EXPECT_EQ((RealTimeRights{.has_priority = true, .has_locked_memory = true}.Refusal()), "");
  EXPECT_THAT((RealTimeRights{.has_priority = true}.Refusal()),
              StartsWith("locked memory is not allowed: wake-ups may be late"));
  EXPECT_THAT((RealTimeRights{.has_locked_memory = true}.Refusal()),
              StartsWith("real-time priority is not allowed"));
  EXPECT_THAT(RealTimeRights{}.Refusal(),
              StartsWith("real-time priority and locked memory are not allowed"));
}

TEST(PeriodicWake, HasItsPeriodsOnAGridWithoutDrift) {
  const PeriodicWake wake(500, 3.0);
  EXPECT_EQ(wake.NominalOf_ns(0), 500);
  EXPECT_EQ(wake.NominalOf_ns(1), 500 + 333'333'333);
  EXPECT_EQ(wake.NominalOf_ns(2), 500 + 666'666'667);
  EXPECT_EQ(wake.NominalOf_ns(3'000'000), 500 + 1'000'000 * kNanosecondsPerSecond);
}

// A thread that is late by ten periods and a half leaves out ten, and never wakes too soon.
TEST(PeriodicWake, LeavesOutWhatItMissed) {
  constexpr std::int64_t kPeriod_ns = 100'000'000;
  const std::int64_t start_ns = MonotonicNow_ns() - 10 * kPeriod_ns - kPeriod_ns / 2;
  PeriodicWake wake(start_ns, 10.0);
  std::int64_t period = -1;
  for (int i = 0; i < 3; ++i) {
    const PeriodicWake::Woken woken = wake.Wait();
    const std::int64_t now_ns = MonotonicNow_ns();
    EXPECT_GE(woken.skipped, i == 0 ? 10 : 0);
    period += 1 + woken.skipped;
    EXPECT_EQ(woken.nominal_ns, start_ns + period * kPeriod_ns);
    EXPECT_GE(woken.lateness_ns, 0);
    EXPECT_LE(woken.nominal_ns + woken.lateness_ns, now_ns);
    EXPECT_GT(woken.nominal_ns + woken.lateness_ns, start_ns + 10 * kPeriod_ns);
  }
  EXPECT_GE(period, 12);
}

// Late by less than a period it leaves out nothing.
TEST(PeriodicWake, IsLateByUpToAPeriodWithoutLeavingOutAny) {
  const std::int64_t start_ns = MonotonicNow_ns() - 5 * kNanosecondsPerSecond;
  PeriodicWake wake(start_ns, 0.1);
  const PeriodicWake::Woken woken = wake.Wait();
  EXPECT_EQ(woken.skipped, 0);
  EXPECT_EQ(woken.nominal_ns, start_ns);
  EXPECT_GE(woken.lateness_ns, 5 * kNanosecondsPerSecond);
}

}  // namespace
}  // namespace gauntlet::sim
