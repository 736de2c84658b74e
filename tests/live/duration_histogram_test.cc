#include "sim/live/duration_histogram.h"

#include <gtest/gtest.h>

#include <cmath>

#include "sim/live/trend.h"

namespace gauntlet::sim {
namespace {

TEST(DurationHistogram, HasStepsOfAMicrosecond) {
  DurationHistogram times;
  for (int us = 1; us <= 1000; ++us) times.Add(1000 * us - 500);
  EXPECT_EQ(times.count(), 1000);
  EXPECT_DOUBLE_EQ(times.mean_us(), 500.0);
  EXPECT_DOUBLE_EQ(times.Quantile_us(0.5), 500.0);
  EXPECT_DOUBLE_EQ(times.Quantile_us(0.99), 990.0);
  EXPECT_DOUBLE_EQ(times.max_us(), 999.5);
  EXPECT_EQ(times.Steps().size(), 1000U);
}

TEST(DurationHistogram, KeepsLongDurationsAndTakesNegativeOnesForZero) {
  DurationHistogram times;
  times.Add(-5);
  times.Add(70'000'000'000);
  times.Add(60'500'000);
  EXPECT_DOUBLE_EQ(times.Quantile_us(0.3), 1.0);
  EXPECT_DOUBLE_EQ(times.Quantile_us(0.6), 61'000.0);
  EXPECT_DOUBLE_EQ(times.Quantile_us(1.0), 70'000'000.0);
}

TEST(DurationHistogram, HasNoQuantileWithoutDurations) {
  EXPECT_TRUE(std::isnan(DurationHistogram().Quantile_us(0.5)));
  EXPECT_TRUE(std::isnan(DurationHistogram().mean_us()));
}

TEST(Trend, FindsTheSlopeOfALineAndNoErrorOfIt) {
  Trend trend;
  for (int i = 0; i < 10; ++i) trend.Add(100.0 + i, 3.0 - 2.0 * i);
  EXPECT_NEAR(trend.slope(), -2.0, 1e-12);
  EXPECT_NEAR(trend.slope_error(), 0.0, 1e-6);
}

TEST(TrendOfSeconds, TellsAQueueThatGrowsByAMillisecondASecond) {
  TrendOfSeconds trend;
  for (int ms = 0; ms < 6000; ms += 10) trend.Add(std::int64_t{1'000'000} * ms, 1e-3 * ms);
  EXPECT_NEAR(trend.trend().slope(), 60.0, 1e-6);
}

}  // namespace
}  // namespace gauntlet::sim
