#include "sim/score/statistics/judgement.h"

#include <gtest/gtest.h>

#include <cmath>

#include "sim/base/student.h"
#include "tests/comparison/simulated_comparisons.h"

namespace gauntlet::sim {
namespace {

Judgement Of(double low, double high, bool lower_is_better = true) {
  const MeanInterval interval{.mean = 0.5 * (low + high), .low = low, .high = high};
  return JudgeDifference(interval, 1.0, lower_is_better);
}

TEST(JudgeDifference, FollowsFromTheIntervalAndWhatMatters) {
  EXPECT_EQ(Of(-3.0, -1.5), Judgement::kBetter);
  EXPECT_EQ(Of(1.5, 3.0), Judgement::kWorse);
  EXPECT_EQ(Of(-0.9, 0.9), Judgement::kEqual);
  EXPECT_EQ(Of(0.1, 0.9), Judgement::kEqual);      // other than 0, but by nothing that matters
  EXPECT_EQ(Of(0.1, 1.1), Judgement::kUndecided);  // may matter
  EXPECT_EQ(Of(-1.1, -0.1), Judgement::kUndecided);
  EXPECT_EQ(Of(-1.5, -0.5), Judgement::kBetter);  // by what just matters
  EXPECT_EQ(Of(0.5, 1.5), Judgement::kWorse);
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

TEST(Judge, PrintsTheIntervalThatDecidesAtTheLevelOfAll) {
  std::vector<Question> questions;
  for (int i = 0; i < 40; ++i) {
    questions.push_back({.difference = {.mean = 0.1 * i * i,
                                        .standard_error = 10.0,
                                        .degrees_of_freedom = 7,
                                        .count = 8},
                         .relevant_difference = 1e-9,
                         .lower_is_better = false});
  }
  questions.push_back({.difference = {.mean = 1.0, .count = 1}});  // cannot be answered
  const std::vector<Comparison> answers = Judge(questions);
  const double half_width = 10.0 * StudentHalfWidth(1.0 - 0.05 / 40, 7);
  for (int i = 0; i < 40; ++i) {
    const MeanInterval& difference = answers[i].difference;
    EXPECT_DOUBLE_EQ(difference.level, 1.0 - 0.05 / 40);
    EXPECT_NEAR(difference.high - difference.mean, half_width, 1e-6);
    EXPECT_EQ(answers[i].judgement,
              difference.low > 0.0 ? Judgement::kBetter : Judgement::kUndecided);
  }
  EXPECT_EQ(answers[39].judgement, Judgement::kBetter);
  EXPECT_EQ(answers[40].judgement, Judgement::kUndecided);
  EXPECT_TRUE(Judge({}).empty());
}

/// More, and more of them: comparison_measurements.
TEST(SimulatedComparisons, AreWrongInAtMost5Percent) {
  for (const Truth truth : {Truth::kEqual, Truth::kMixed, Truth::kAtLimit}) {
    for (const auto& [motions, noises] : {std::pair(1, 8), {4, 2}}) {
      const ComparisonsOutcome outcome = SimulateComparisons({.truth = truth,
                                                              .scatter_size = 1.0,
                                                              .motions = motions,
                                                              .noises = noises,
                                                              .studies = 100});
      // 5 % of 100 and twice their standard error.
      EXPECT_LE(outcome.false_verdict, 0.05 + 2.0 * 0.022) << motions;
      EXPECT_LE(outcome.false_other, 0.05 + 2.0 * 0.022) << motions;
      EXPECT_NEAR(outcome.coverage, 0.95, 0.02) << motions;
    }
  }
}

TEST(SimulatedComparisons, FindWhatIsThere) {
  const ComparisonsOutcome outcome = SimulateComparisons({.noises = 16, .studies = 10});
  const auto& [equal, slight, clear] = outcome.of_truth;
  EXPECT_GT(equal.equal, 0.95);
  EXPECT_GT(clear.right, 0.95);
}

}  // namespace
}  // namespace gauntlet::sim
