#include "sim/study/judgement.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/study/simulated_comparisons.h"

namespace gauntlet::sim {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

Judgement Of(double low, double high, bool lower_is_better = true) {
  const MeanInterval interval{.mean = 0.5 * (low + high), .low = low, .high = high};
  return JudgeDifference(interval, 1.0, lower_is_better);
}

TEST(JudgeDifference, FollowsFromTheIntervalAndWhatMatters) {
  EXPECT_EQ(Of(-3.0, -1.5), Judgement::kBetter);
  EXPECT_EQ(Of(1.5, 3.0), Judgement::kWorse);
  EXPECT_EQ(Of(-0.9, 0.9), Judgement::kEqual);
  EXPECT_EQ(Of(0.1, 0.9), Judgement::kEqual);       // other than 0, but by nothing that matters
  EXPECT_EQ(Of(0.1, 1.1), Judgement::kUndecided);   // may matter
  EXPECT_EQ(Of(0.1, 2.1), Judgement::kWorse);       // does in the mean, and is surely above 0
  EXPECT_EQ(Of(-0.1, 5.0), Judgement::kUndecided);  // may be nothing
  EXPECT_EQ(Of(-1.0, 0.5), Judgement::kUndecided);  // what just matters does matter
  EXPECT_EQ(Of(0.0, 4.0), Judgement::kUndecided);   // 0 is in the interval
  EXPECT_EQ(Of(-3.0, -1.5, false), Judgement::kWorse);
  EXPECT_EQ(Of(1.5, 3.0, false), Judgement::kBetter);
  EXPECT_EQ(Of(0.0, 0.0), Judgement::kEqual);
}

TEST(JudgeDifference, WithoutAnIntervalOrAValue) {
  EXPECT_EQ(JudgeDifference({.mean = 3.0}, 1.0, true), Judgement::kUndecided);
  EXPECT_EQ(JudgeDifference({}, 1.0, true), Judgement::kNone);
}

TEST(HolmLevels, AreThoseOfTheStepsDown) {
  // By hand: 0.05 / 4 = 0.0125, 0.05 / 3 = 0.01667, 0.05 / 2 = 0.025 < 0.03 stops.
  const std::vector<double> levels = HolmLevels(std::vector<double>{0.03, 0.01, kNaN, 0.04, 0.015});
  EXPECT_DOUBLE_EQ(levels[1], 1.0 - 0.05 / 4);
  EXPECT_DOUBLE_EQ(levels[4], 1.0 - 0.05 / 3);
  EXPECT_DOUBLE_EQ(levels[0], 1.0 - 0.05 / 2);
  EXPECT_DOUBLE_EQ(levels[3], 1.0 - 0.05 / 2);
  EXPECT_DOUBLE_EQ(levels[2], 1.0 - 0.05 / 2);
  EXPECT_DOUBLE_EQ(HolmLevels(std::vector<double>{0.04})[0], 0.95);
  EXPECT_TRUE(HolmLevels({}).empty());
}

TEST(Judge, PrintsTheIntervalThatDecides) {
  std::vector<Question> questions;
  for (int i = 0; i < 40; ++i) {
    questions.push_back({.difference = {.mean = 0.1 * i * i,
                                        .standard_error = 10.0,
                                        .degrees_of_freedom = 7,
                                        .count = 8},
                         .relevant_difference = 1e-9,
                         .lower_is_better = false});
  }
  const std::vector<Comparison> answers = Judge(questions);
  int fallen = 0;
  for (const Comparison& answer : answers) {
    const bool excludes_zero = answer.difference.low > 0.0;
    EXPECT_EQ(answer.judgement, excludes_zero ? Judgement::kBetter : Judgement::kUndecided);
    fallen += excludes_zero;
  }
  EXPECT_GT(fallen, 5);
  EXPECT_LT(fallen, 30);
  EXPECT_DOUBLE_EQ(answers.back().difference.level, 1.0 - 0.05 / 40);  // the largest falls first
  EXPECT_DOUBLE_EQ(answers.front().difference.level, 1.0 - 0.05 / (40 - fallen));
}

/// More, and more of them: comparison_measurements.
TEST(SimulatedComparisons, AreWrongInAtMost5Percent) {
  using namespace test;
  for (const Truth truth : {Truth::kEqual, Truth::kMixed, Truth::kAtLimit}) {
    for (const auto& [motions, noises] : {std::pair(1, 8), {4, 2}}) {
      const ComparisonsOutcome outcome = SimulateComparisons({.truth = truth,
                                                              .scatter_size = 1.0,
                                                              .motions = motions,
                                                              .noises = noises,
                                                              .studies = 100});
      // 5 % of 100 and twice their standard error.
      EXPECT_LE(outcome.false_verdict, 0.05 + 2.0 * 0.022) << motions;
      EXPECT_NEAR(outcome.coverage, 0.95, 0.02) << motions;
    }
  }
}

TEST(SimulatedComparisons, FindWhatIsThere) {
  using namespace test;
  const ComparisonsOutcome outcome = SimulateComparisons({.noises = 16, .studies = 10});
  const auto& [equal, slight, clear] = outcome.of_truth;
  EXPECT_GT(equal.equal, 0.95);
  EXPECT_GT(clear.right, 0.95);
}

}  // namespace
}  // namespace gauntlet::sim
