#include "sim/score/statistics/blocks.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "sim/base/normal_pair.h"
#include "sim/base/random.h"
#include "sim/score/statistics/statistics.h"
#include "tests/statistics/simulated_recordings.h"

namespace gauntlet::sim {
namespace {

using Series = std::vector<double>;

/// x_n = decay x_(n-1) + white noise: an autocorrelation time of (1 + decay) / (1 - decay).
Series Autoregressive(double decay, int count, double size = 1.0) {
  RandomStream random(5, "autoregressive", static_cast<std::uint64_t>(1000.0 * decay));
  Series series;
  double value = 0.0;
  for (int n = 0; n < count; ++n) {
    value = decay * value + BoxMuller(random).first;
    series.push_back(size * value);
  }
  return series;
}

TEST(AutocorrelationTime, IsThatOfAnAutoregressiveProcess) {
  for (const double decay : {0.0, 0.5, 0.9}) {
    const Series series = Autoregressive(decay, 100'000);
    const double truth = (1.0 + decay) / (1.0 - decay);
    EXPECT_NEAR(AutocorrelationTime({&series, 1}), truth, 0.15 * truth) << decay;
  }
}

TEST(AutocorrelationTime, OfSeveralSeriesTheOneWithMoreScatterDecides) {
  const std::vector<Series> series = {Autoregressive(0.9, 5000), Autoregressive(0.0, 5000, 50.0)};
  EXPECT_LT(AutocorrelationTime(series), 1.3);
  const std::vector<Series> other = {Autoregressive(0.9, 5000, 50.0), Autoregressive(0.0, 5000)};
  EXPECT_GT(AutocorrelationTime(other), 14.0);
}

TEST(AutocorrelationTime, IsOneWhereNothingScatters) {
  const Series equal(10, 3.0);
  EXPECT_EQ(AutocorrelationTime({&equal, 1}), 1.0);
  EXPECT_EQ(AutocorrelationTime({}), 1.0);
}

TEST(PlanBlocks, KeepsBlocksLongerThanTheCorrelation) {
  EXPECT_EQ(PlanBlocks(60.0, 1.0).count, 12);   // of 5 s, the shortest
  EXPECT_EQ(PlanBlocks(600.0, 1.0).count, 16);  // the most
  EXPECT_EQ(PlanBlocks(100.0, 2.5).count, 10);  // of four times the correlation
  EXPECT_EQ(PlanBlocks(100.0, 5.0).count, 8);   // the fewest
  EXPECT_EQ(PlanBlocks(100.0, 6.5).count, 0);   // too short for 8 of twice the correlation
  EXPECT_EQ(PlanBlocks(39.9, 1.0).count, 0);
  EXPECT_DOUBLE_EQ(PlanBlocks(100.0, 6.5).needed_s, 104.0);
  EXPECT_DOUBLE_EQ(PlanBlocks(100.0, 5.0).length_s, 12.5);
  EXPECT_DOUBLE_EQ(PlanBlocks(100.0, 5.0).Widening(), 1.0 / std::sqrt(0.8));
}

TEST(BlockValues, OfAMeanAreTheMeansOfTheBlocks) {
  const Series blocks = {1.0, 4.0, 2.0, 9.0};
  Series without;
  for (const double block : blocks) without.push_back((16.0 - block) / 3.0);
  const Series values = BlockValues(4.0, without, 1.0);
  for (std::size_t i = 0; i < blocks.size(); ++i) EXPECT_DOUBLE_EQ(values[i], blocks[i]);
}

TEST(BlockValues, HaveTheScoreOfTheWholeAsMeanAndAreWidened) {
  const Series values = BlockValues(5.0, Series{1.0, 2.0, 3.0}, 1.5);
  EXPECT_DOUBLE_EQ(std::accumulate(values.begin(), values.end(), 0.0) / 3.0, 5.0);
  EXPECT_DOUBLE_EQ(values[0], 8.0);
  EXPECT_DOUBLE_EQ(values[2], 2.0);
}

/// More of them: block_coverage.
TEST(SimulatedRecordings, HaveIntervalsThatCoverIn93To97Percent) {
  struct Case {
    RecordedErrors errors;
    double correlation_s;
    double duration_s;
  };
  for (const auto& [errors, correlation_s, duration_s] :
       {Case{RecordedErrors::kOwn, 1.0, 60.0}, Case{RecordedErrors::kShared, 1.0, 60.0},
        Case{RecordedErrors::kOscillating, 1.0, 60.0}, Case{RecordedErrors::kLevel, 1.0, 100.0},
        Case{RecordedErrors::kMovements, 2.0, 60.0}}) {
    const RecordingsOutcome outcome = SimulateRecordings({.errors = errors,
                                                          .correlation_s = correlation_s,
                                                          .duration_s = duration_s,
                                                          .recordings = 1000});
    EXPECT_GE(outcome.with_intervals, 0.9);
    // Two standard errors of 1,000 are 1.4 %.
    EXPECT_GE(outcome.coverage, 0.93 - 0.014) << static_cast<int>(errors);
    EXPECT_LE(outcome.coverage, 0.97 + 0.014) << static_cast<int>(errors);
  }
}

TEST(SimulatedRecordings, AreTooShortForLongCorrelations) {
  const RecordingsOutcome outcome = SimulateRecordings(
      {.errors = RecordedErrors::kLevel, .correlation_s = 10.0, .duration_s = 60.0});
  EXPECT_LE(outcome.with_intervals, 0.05);
}

}  // namespace
}  // namespace gauntlet::sim
