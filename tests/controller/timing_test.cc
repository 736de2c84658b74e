#include "controller/timing.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <vector>

#include "controller/periodic_clock.h"

namespace gauntlet::controller {
namespace {

std::vector<int> TicksOf(double period_ticks, int ticks) {
  PeriodicClock clock(period_ticks);
  std::vector<int> due;
  for (int tick = 0; tick < ticks; ++tick) {
    if (clock.Tick()) due.push_back(tick);
  }
  return due;
}

TEST(PeriodicClock, IsDueAtTheFirstTickAtOrAfterEachPeriod) {
  EXPECT_THAT(TicksOf(3.0, 10), testing::ElementsAre(0, 3, 6, 9));
  EXPECT_THAT(TicksOf(2.5, 12), testing::ElementsAre(0, 3, 5, 8, 10));
  EXPECT_THAT(TicksOf(1.0, 4), testing::ElementsAre(0, 1, 2, 3));
  EXPECT_THAT(TicksOf(0.3, 4), testing::ElementsAre(0, 1, 2, 3));
}

TEST(PeriodicClock, DoesNotDrift) {
  const double period = 20.0 * 1.0323;  // events of 20 ms on the ticks of a glove of 33.3 Hz
  const std::vector<int> due = TicksOf(period, 1'000'000);
  ASSERT_EQ(due.size(), static_cast<std::size_t>(1'000'000 / period) + 1);
  for (std::size_t i = 0; i < due.size(); ++i) {
    ASSERT_GE(due[i] + 1e-5, i * period);
    ASSERT_LT(due[i], i * period + 1.0);
  }
}

TEST(PeriodicClock, BeginsAnewAfterReset) {
  PeriodicClock clock(5.0);
  clock.Tick();
  clock.Tick();
  clock.Reset();
  EXPECT_TRUE(clock.Tick());
  EXPECT_FALSE(clock.Tick());
}

TEST(Timing, KnowsItsRates) {
  const Timing timing = {.tick_rate_hz = 1020.0, .ticks_per_sample = 17, .event_period_ms = 20.0};
  EXPECT_DOUBLE_EQ(timing.sample_rate_hz(), 60.0);
  EXPECT_DOUBLE_EQ(timing.event_rate_hz(), 50.0);
  EXPECT_EQ(Timing{}.TicksOf(20.0), 20.0);
  EXPECT_EQ(Timing{}.event_rate_hz(), 50.0);
}

}  // namespace
}  // namespace gauntlet::controller
