#include "sim/recordings/table_statistics.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <span>
#include <stdexcept>

namespace gauntlet::sim {
namespace {

TEST(TableStatistics, KeepsFewRowsOfALongTableSpreadOverAllOfIt) {
  TableStatistics statistics(2);
  constexpr int kTableRows = 300'000;
  for (int row = 0; row < kTableRows; ++row) {
    const double values[] = {static_cast<double>(row % 1000), std::nan("")};
    statistics.Add(0.01 * row, values);
  }
  EXPECT_EQ(statistics.rows(), 300'000U);
  EXPECT_GE(statistics.kept_times_s().size(), 4096U);
  EXPECT_LE(statistics.kept_times_s().size(), 8192U);
  EXPECT_GT(statistics.kept_times_s().back(), 0.999 * 0.01 * kTableRows);
  const ColumnStatistics column = statistics.Column(0);
  EXPECT_EQ(column.low, 0.0);
  EXPECT_EQ(column.high, 999.0);
  EXPECT_NEAR(column.usual_low, 5.0, 10.0);
  EXPECT_NEAR(column.usual_high, 994.0, 10.0);
  EXPECT_EQ(statistics.Column(1).good_rows, 0U);
  EXPECT_NEAR(statistics.Time().rate_hz, 100.0, 1e-6);
  EXPECT_NEAR(statistics.Time().duration_s, 0.01 * (kTableRows - 1), 1e-6);
}

TEST(TableStatistics, CountsTheRowsBetweenTheStepsOfACoarseClock) {
  TableStatistics statistics(1);
  const double value = 0.0;
  for (int row = 0; row < 230; ++row) statistics.Add(std::floor(0.83 + 0.01 * row), {&value, 1});
  EXPECT_DOUBLE_EQ(statistics.Time().mean_rate_hz, 100.0);
}

/// A code for a missing value is none of the values: wrong are a range four times as wide, and an
/// unknown unit. Inside the range of the others it is a value.
TEST(TableStatistics, KnowsCodesOfMissingValues) {
  TableStatistics statistics(2);
  for (int row = 0; row < 3000; ++row) {
    const double angle = 4250.0 + 3750.0 * std::sin(0.02 * row);
    const bool is_lost = row >= 700 && row < 720;
    const double values[] = {is_lost ? 32767.0 : std::round(angle), row % 1024 * 1.0};
    statistics.Add(0.01 * row, values);
  }
  const ColumnStatistics lost = statistics.Column(0);
  EXPECT_EQ(lost.code, 32767.0);
  EXPECT_NEAR(lost.code_share, 20.0 / 3000.0, 1e-9);
  EXPECT_EQ(lost.high, 8000.0);
  EXPECT_LE(lost.usual_high, 8000.0);
  EXPECT_EQ(lost.spike_share, 0.0);
  const ColumnStatistics counts = statistics.Column(1);
  EXPECT_EQ(counts.code_share, 0.0);
  EXPECT_EQ(counts.high, 1023.0);
}

TEST(TableStatistics, RefusesRowsAndColumnsOfAnotherTable) {
  TableStatistics statistics(2);
  const double values[] = {1.0, 2.0, 3.0};
  EXPECT_THROW(statistics.Add(0.0, values), std::logic_error);
  statistics.Add(0.0, std::span(values).first(2));
  EXPECT_THROW(statistics.Column(2), std::logic_error);
  EXPECT_THROW(statistics.KeptValues(2), std::logic_error);
}

TEST(TableStatistics, StaysFiniteWhereNumbersAreNot) {
  TableStatistics statistics(1);
  for (const double value : {1e308, -1e308, 1.0, 2.0, 1.0, std::nan("")}) {
    statistics.Add(1e300 * value, {&value, 1});
  }
  EXPECT_EQ(statistics.Column(0).good_rows, 3u);
  EXPECT_EQ(statistics.Column(0).high, 2.0);
  EXPECT_EQ(statistics.Column(0).step, 1.0);
  EXPECT_TRUE(std::isfinite(statistics.Column(0).noise));
  EXPECT_EQ(statistics.Time().duration_s, 0.0);
}

TEST(TableStatistics, KnowsTheRangeOfAColumnThatKeptRowsMiss) {
  TableStatistics statistics(1);
  for (int row = 0; row < 20'000; ++row) {
    const double value = row % 2 == 1 ? row : std::nan("");
    statistics.Add(0.01 * row, {&value, 1});
  }
  EXPECT_EQ(statistics.Column(0).usual_low, 1.0);
  EXPECT_EQ(statistics.Column(0).usual_high, 19'999.0);
}

TEST(UsualInterval, IsMovedNeitherByGapsNorByBunches) {
  // Four rows come together every 40 ms, and once nothing for a minute.
  std::vector<double> bunched;
  for (int i = 0; i < 400; ++i) bunched.push_back(i % 4 == 0 ? 0.037 : 0.001);
  bunched[120] = 60.0;
  EXPECT_NEAR(UsualInterval(bunched), 0.01, 1e-9);
  const std::vector<double> few = {0.1, 0.1, 0.1};
  EXPECT_NEAR(UsualInterval(few), 0.1, 1e-9);
  EXPECT_TRUE(std::isnan(UsualInterval({})));
}

TEST(TableStatistics, CountsGapsAndRestartsOfTheClock) {
  TableStatistics statistics(1);
  const double value[] = {1.0};
  for (int row = 0; row < 100; ++row) statistics.Add(0.01 * row + (row > 50 ? 3.0 : 0.0), value);
  for (int row = 0; row < 100; ++row) statistics.Add(0.01 * row, value);
  const TimeStatistics time = statistics.Time();
  EXPECT_EQ(time.gaps, 1U);
  EXPECT_NEAR(time.longest_gap_s, 3.01, 1e-9);
  EXPECT_EQ(time.restarts, 1U);
  EXPECT_NEAR(time.rate_hz, 100.0, 1e-6);
  EXPECT_EQ(statistics.Column(0).longest_still_rows, 200U);
}

}  // namespace
}  // namespace gauntlet::sim
