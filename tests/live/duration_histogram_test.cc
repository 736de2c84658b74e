#include "sim/live/duration_histogram.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <utility>
#include <vector>

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

TEST(DurationHistogram, HasStepsOfAMillisecondFrom50MillisecondsTo60Seconds) {
  DurationHistogram times;
  const std::vector<std::pair<std::int64_t, double>> steps_us = {{0, 0.0},
                                                                 {999, 0.0},
                                                                 {1'000, 1.0},
                                                                 {49'999'999, 49'999.0},
                                                                 {50'000'000, 50'000.0},
                                                                 {50'999'999, 50'000.0},
                                                                 {51'000'000, 51'000.0},
                                                                 {59'998'999'999, 59'998'000.0},
                                                                 {59'999'000'000, 59'999'000.0},
                                                                 {90'000'000'000, 59'999'000.0}};
  for (const auto& [ns, step_us] : steps_us) times.Add(ns);
  std::map<double, std::int64_t> expected;
  for (const auto& [ns, step_us] : steps_us) ++expected[step_us];
  const auto steps = times.Steps();
  EXPECT_EQ((std::map(steps.begin(), steps.end())), expected);
  EXPECT_EQ(times.Quantile_us(0.8), 59'999'000.0);
  EXPECT_EQ(times.Quantile_us(0.7), 52'000.0);
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

/// Off the line by (1, -2, 1): S_yy = 6, and sqrt(6 / (1 * 2)) is the error.
TEST(Trend, HasTheErrorOfLeastSquares) {
  Trend trend;
  EXPECT_TRUE(std::isnan(trend.slope()));
  trend.Add(9.0, 1.0 + 5.0);
  trend.Add(10.0, -2.0 + 7.0);
  EXPECT_TRUE(std::isnan(trend.slope())) << "of two values";
  trend.Add(11.0, 1.0 + 9.0);
  EXPECT_NEAR(trend.slope(), 2.0, 1e-12);
  EXPECT_NEAR(trend.slope_error(), std::sqrt(3.0), 1e-12);
  EXPECT_EQ(trend.count(), 3);
}

TEST(TrendOfSeconds, IsOfTheMeansOfWholeSeconds) {
  TrendOfSeconds trend;
  constexpr std::int64_t kHalf_ns = 500'000'000;
  for (int i = 0; i < 7; ++i) trend.Add(kHalf_ns * i, i % 2 == 0 ? 0.0 : 4.0 * (i / 2));
  EXPECT_EQ(trend.trend().count(), 3);  // means 0, 2 and 4; the fourth second has begun
  EXPECT_NEAR(trend.trend().slope(), 60.0 * 2.0, 1e-9);
}

TEST(TrendOfSeconds, TellsAQueueThatGrowsByAMillisecondASecond) {
  TrendOfSeconds trend;
  for (int ms = 0; ms < 6000; ms += 10) trend.Add(std::int64_t{1'000'000} * ms, 1e-3 * ms);
  EXPECT_NEAR(trend.trend().slope(), 60.0, 1e-6);
}

}  // namespace
}  // namespace gauntlet::sim
