#include "sim/score/statistics/statistics.h"

#include <gtest/gtest.h>

#include <cmath>

#include "sim/base/normal_pair.h"
#include "sim/base/random.h"
#include "sim/base/signal.h"

namespace gauntlet::sim {
namespace {

double Normal(RandomStream& random) { return BoxMuller(random).first; }

/// Share of 4,000 simulated studies whose 95 % interval holds the true mean, 3: of so many motions
/// with so many noises each, the scatter of motions twice that of noise.
double Coverage(int motions, int noises) {
  constexpr int kStudies = 4000;
  RandomStream random(17, "simulated studies", static_cast<std::uint64_t>(100 * motions + noises));
  int covered = 0;
  for (int study = 0; study < kStudies; ++study) {
    std::vector<double> values;
    std::vector<int> motion_of;
    for (int g = 0; g < motions; ++g) {
      const double motion = motions > 1 ? 3.0 + 2.0 * Normal(random) : 3.0;
      for (int i = 0; i < noises; ++i) {
        values.push_back(motion + Normal(random));
        motion_of.push_back(g);
      }
    }
    const MeanInterval interval = EstimateMean(values, motion_of).IntervalAt(0.95);
    covered += interval.low <= 3.0 && 3.0 <= interval.high;
  }
  return static_cast<double>(covered) / kStudies;
}

TEST(EstimateMean, CoversTheTruthIn93To97PercentOfStudiesOfOneMotion) {
  for (const int noises : {2, 3, 4, 5, 8, 16, 32}) {
    EXPECT_NEAR(Coverage(1, noises), 0.95, 0.02) << noises << " noises";
  }
}

TEST(EstimateMean, CoversTheTruthIn93To97PercentOfStudiesOfSeveralMotions) {
  for (const auto& [motions, noises] : {std::pair(2, 2), {2, 16}, {3, 1}, {4, 4}, {16, 2}}) {
    EXPECT_NEAR(Coverage(motions, noises), 0.95, 0.02) << motions << " x " << noises;
  }
}

TEST(EstimateMean, SeedsOfOneMotionAreNoMoreMotions) {
  // Three demonstrations with eight noises each: 24 values, but the truth is known from three.
  std::vector<double> values;
  std::vector<int> motions;
  for (int seed = 0; seed < 24; ++seed) {
    constexpr double kMotion[] = {4.7, 6.3, 6.4};
    values.push_back(kMotion[seed % 3] + 0.01 * std::sin(seed));
    motions.push_back(seed % 3);
  }
  const MeanEstimate of_motions = EstimateMean(values, motions);
  const MeanEstimate of_noise = EstimateMean(values);
  EXPECT_EQ(of_motions.degrees_of_freedom, 2.0);
  EXPECT_EQ(of_noise.degrees_of_freedom, 23.0);
  EXPECT_NEAR(of_motions.mean, 5.8, 0.01);
  EXPECT_NEAR(of_motions.standard_error, std::sqrt(2.0 * (1.1 * 1.1 + 0.5 * 0.5 + 0.6 * 0.6) / 12),
              0.01);  // of 4.7, 6.3, 6.4
  EXPECT_GT(of_motions.IntervalAt().high - of_motions.mean,
            5.0 * (of_noise.IntervalAt().high - of_noise.mean));
  EXPECT_GT(of_motions.motion_share, 0.999);
  EXPECT_TRUE(std::isnan(of_noise.motion_share));
}

TEST(EstimateMean, GivesEveryMotionTheSameWeight) {
  const std::vector<double> values{1.0, 3.0, 3.0, 3.0, kNaN, 5.0};
  const MeanEstimate estimate = EstimateMean(values, std::vector<int>{0, 7, 7, 7, 7, 9});
  EXPECT_EQ(estimate.mean, 3.0);
  EXPECT_EQ(estimate.count, 5);
  EXPECT_EQ(estimate.degrees_of_freedom, 2.0);
  EXPECT_NEAR(estimate.standard_error, 2.0 / std::sqrt(3.0), 1e-12);
}

TEST(EstimateMean, TellsTheMotionsShareOfTheVariance) {
  const std::vector<double> values{1.0, 3.0, 5.0, 7.0, 3.0, 5.0};
  const std::vector<int> motions{0, 0, 1, 1, 2, 2};
  // By hand: means 2, 6, 4, so MSB = 2 (4 + 4 + 0) / 2 = 8; MSW = 2; of motions (8 - 2) / 2 = 3.
  EXPECT_NEAR(EstimateMean(values, motions).motion_share, 3.0 / 5.0, 1e-12);
  EXPECT_TRUE(
      std::isnan(EstimateMean(std::vector<double>{1, 2}, std::vector<int>{0, 1}).motion_share));
  EXPECT_EQ(
      EstimateMean(std::vector<double>{1, 9, 2, 8}, std::vector<int>{0, 0, 1, 1}).motion_share,
      0.0);  // motions alike: never below zero
  RandomStream random(4, "shares");
  double sum = 0.0;
  for (int study = 0; study < 400; ++study) {
    std::vector<double> drawn;
    std::vector<int> of_motion;
    for (int g = 0; g < 20; ++g) {
      const double motion = Normal(random);
      for (int i = 0; i < 1 + g % 3; ++i) {  // unbalanced
        drawn.push_back(motion + 2.0 * Normal(random));
        of_motion.push_back(g);
      }
    }
    sum += EstimateMean(drawn, of_motion).motion_share / 400;
  }
  EXPECT_NEAR(sum, 0.2, 0.03);  // 1 of 1 + 4
}

TEST(EstimateMean, OfAScoreThatOneOfSeveralMotionsHasIsWithoutAnInterval) {
  const std::vector<double> values{1.0, 1.1, kNaN, kNaN};
  const MeanEstimate estimate = EstimateMean(values, std::vector<int>{0, 0, 1, 1});
  EXPECT_NEAR(estimate.mean, 1.05, 1e-12);
  EXPECT_TRUE(std::isnan(estimate.IntervalAt().low));
}

TEST(EstimateMean, FollowsScaleAndOffset) {
  const std::vector<double> values{1, 4, 2, 8, 5, 7, 3};
  std::vector<double> moved;
  for (const double value : values) moved.push_back(100.0 - 8.0 * value);
  const MeanInterval interval = EstimateMean(values).IntervalAt(0.99);
  const MeanInterval mirrored = EstimateMean(moved).IntervalAt(0.99);
  EXPECT_NEAR(mirrored.mean, 100.0 - 8.0 * interval.mean, 1e-12);
  EXPECT_NEAR(mirrored.low, 100.0 - 8.0 * interval.high, 1e-9);
  EXPECT_NEAR(mirrored.high, 100.0 - 8.0 * interval.low, 1e-9);
}

TEST(EstimateMean, OfFewEqualOrMissingValues) {
  const MeanInterval none = EstimateMean(std::vector<double>{kNaN}).IntervalAt();
  EXPECT_TRUE(std::isnan(none.mean));
  const MeanInterval one = EstimateMean(std::vector<double>{2.5, kNaN}).IntervalAt();
  EXPECT_EQ(one.mean, 2.5);
  EXPECT_TRUE(std::isnan(one.low));
  const MeanEstimate equal = EstimateMean(std::vector<double>(9, 0.1));
  EXPECT_EQ(equal.mean, 0.1);
  EXPECT_EQ(equal.IntervalAt(0.999).low, 0.1);
  EXPECT_EQ(equal.IntervalAt(0.999).high, 0.1);
  const MeanInterval two = EstimateMean(std::vector<double>{1.0, 3.0}).IntervalAt();
  EXPECT_NEAR(two.high, 2.0 + 12.7062, 1e-3);  // Student's t with one degree of freedom
}

TEST(EstimateMean, OfOneFarValueIsNoWiderThanTheValues) {
  // Delays of eight seeds in ms: the last one's true scatter is unknown, but no mean of such values
  // can lie thousands of milliseconds away.
  const std::vector<double> values{45.1, 45.0, 45.2, 44.9, 45.0, 45.1, 44.8, 175.0};
  const MeanInterval interval = EstimateMean(values).IntervalAt();
  EXPECT_GT(interval.low, 61.2625 - 130.2);
  EXPECT_LT(interval.high, 61.2625 + 130.2);
  EXPECT_GT(interval.high - interval.low, 30.0);  // nor is it hidden
}

TEST(EstimateDifference, IsNarrowWherePairsShareTheirDifficulty) {
  RandomStream random(8, "pairs");
  std::vector<double> first, second;
  for (int i = 0; i < 12; ++i) {
    const double shared = 10.0 * Normal(random);
    first.push_back(shared + 1.0 + 0.1 * Normal(random));
    second.push_back(shared);
  }
  first.push_back(kNaN);
  second.push_back(5.0);
  const MeanInterval difference = EstimateDifference(first, second).IntervalAt();
  EXPECT_NEAR(difference.mean, 1.0, 0.1);
  EXPECT_GT(difference.low, 0.8);
  EXPECT_LT(difference.high, 1.2);
  EXPECT_EQ(difference.count, 12);
}

TEST(EstimateUnpairedDifference, CoversTheTruthOfGroupsOfOtherSizeAndScatter) {
  constexpr int kStudies = 2000;
  RandomStream random(5, "two groups");
  int covered = 0;
  for (int study = 0; study < kStudies; ++study) {
    std::vector<double> first(6), second(12);
    for (double& value : first) value = 2.0 + 3.0 * Normal(random);
    for (double& value : second) value = 1.0 + Normal(random);
    const MeanInterval interval = EstimateUnpairedDifference(first, second).IntervalAt();
    covered += interval.low <= 1.0 && 1.0 <= interval.high;
  }
  EXPECT_GE(covered, 0.93 * kStudies);
  EXPECT_LE(covered, 0.97 * kStudies);
}

TEST(EstimateUnpairedDifference, OfEqualScattersIsStudentsTwoSampleTest) {
  // Means 2 and 5, variance 1 each: error sqrt(2 / 3), 4 degrees of freedom, t = 2.7764.
  const MeanInterval interval =
      EstimateUnpairedDifference(std::vector<double>{1, 2, 3}, std::vector<double>{4, 5, 6, kNaN})
          .IntervalAt();
  EXPECT_DOUBLE_EQ(interval.mean, -3.0);
  EXPECT_NEAR(interval.low, -3.0 - 2.7764 * std::sqrt(2.0 / 3.0), 1e-4);
  EXPECT_NEAR(interval.high, -3.0 + 2.7764 * std::sqrt(2.0 / 3.0), 1e-4);
}

TEST(EstimateUnpairedDifference, OfFewOrEqualValues) {
  const std::vector<double> one{2.0};
  const std::vector<double> equal{5.0, 5.0};
  const auto interval = [](const std::vector<double>& a, const std::vector<double>& b) {
    return EstimateUnpairedDifference(a, b).IntervalAt();
  };
  EXPECT_EQ(interval(one, equal).mean, -3.0);
  EXPECT_TRUE(std::isnan(interval(one, equal).low));
  EXPECT_EQ(interval(equal, equal).low, 0.0);
  EXPECT_EQ(interval(equal, equal).high, 0.0);
  EXPECT_NEAR(interval({0, 1}, equal).high, -4.5 + 12.7062 * 0.5, 1e-3);  // one degree of freedom
}

TEST(PairedEffectSize, IsTheMeanOverTheScatter) {
  const std::vector<double> first{3, 5, 7};
  const std::vector<double> second{2, 3, 4};
  EXPECT_DOUBLE_EQ(PairedEffectSize(first, second), 2.0);  // differences 1, 2, 3
  EXPECT_DOUBLE_EQ(PairedEffectSize(second, first), -2.0);
  EXPECT_TRUE(std::isnan(PairedEffectSize(first, first)));
}

}  // namespace
}  // namespace gauntlet::sim
