#include "sim/study/statistics.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "sim/base/random.h"

namespace gauntlet::sim {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

double Normal(RandomStream& random) {
  return std::sqrt(-2.0 * std::log(random.UniformAboveZero())) *
         std::cos(2.0 * std::numbers::pi * random.Uniform());
}

/// Share of 2,000 simulated studies of `seeds` values whose interval holds the true mean.
template <class Draw>
double Coverage(int seeds, double truth, Draw draw) {
  constexpr int kStudies = 2000;
  RandomStream random(17, "simulated studies", static_cast<std::uint64_t>(seeds));
  int covered = 0;
  for (int study = 0; study < kStudies; ++study) {
    std::vector<double> values(static_cast<std::size_t>(seeds));
    for (double& value : values) value = draw(random);
    const MeanInterval interval = BootstrapMean(values, static_cast<std::uint64_t>(study));
    covered += interval.ci95_low <= truth && truth <= interval.ci95_high;
  }
  return static_cast<double>(covered) / kStudies;
}

TEST(BootstrapMean, CoversTheTruthIn93To97PercentOfStudies) {
  for (const int seeds : {2, 3, 4, 5, 8, 16, 32}) {
    const double share =
        Coverage(seeds, 3.0, [](RandomStream& random) { return 3.0 + Normal(random); });
    EXPECT_GE(share, 0.93) << seeds << " seeds";
    EXPECT_LE(share, 0.97) << seeds << " seeds";
  }
}

TEST(BootstrapMean, CoversTheTruthOfSkewedScores) {
  const double share =
      Coverage(32, 1.0, [](RandomStream& random) { return -std::log(random.UniformAboveZero()); });
  EXPECT_GE(share, 0.93);
  EXPECT_LE(share, 0.97);
}

TEST(BootstrapMean, DependsOnItsSeedOnly) {
  RandomStream random(3, "values");
  std::vector<double> values(12);
  for (double& value : values) value = Normal(random);
  const MeanInterval first = BootstrapMean(values, 1);
  const MeanInterval again = BootstrapMean(values, 1);
  const MeanInterval other = BootstrapMean(values, 2);
  EXPECT_EQ(first.ci95_low, again.ci95_low);
  EXPECT_EQ(first.ci95_high, again.ci95_high);
  EXPECT_NE(first.ci95_low, other.ci95_low);
  EXPECT_NEAR(first.ci95_low, other.ci95_low, 0.2);
  EXPECT_LT(first.ci95_low, first.mean);
  EXPECT_GT(first.ci95_high, first.mean);
}

TEST(BootstrapMean, FollowsScaleAndOffset) {
  const std::vector<double> values{1, 4, 2, 8, 5, 7, 3};
  std::vector<double> moved;
  for (const double value : values) moved.push_back(100.0 - 8.0 * value);
  const MeanInterval interval = BootstrapMean(values, 4);
  const MeanInterval mirrored = BootstrapMean(moved, 4);
  EXPECT_NEAR(mirrored.mean, 100.0 - 8.0 * interval.mean, 1e-12);
  EXPECT_NEAR(mirrored.ci95_low, 100.0 - 8.0 * interval.ci95_high, 1e-9);
  EXPECT_NEAR(mirrored.ci95_high, 100.0 - 8.0 * interval.ci95_low, 1e-9);
}

TEST(BootstrapMean, OfFewEqualOrMissingValues) {
  const MeanInterval none = BootstrapMean(std::vector<double>{kNaN}, 1);
  EXPECT_TRUE(std::isnan(none.mean));
  const MeanInterval one = BootstrapMean(std::vector<double>{2.5, kNaN}, 1);
  EXPECT_EQ(one.mean, 2.5);
  EXPECT_TRUE(std::isnan(one.ci95_low));
  const MeanInterval equal = BootstrapMean(std::vector<double>(9, 0.1), 1);
  EXPECT_EQ(equal.mean, 0.1);
  EXPECT_EQ(equal.ci95_low, 0.1);
  EXPECT_EQ(equal.ci95_high, 0.1);
  const MeanInterval two = BootstrapMean(std::vector<double>{1.0, 3.0}, 1);
  EXPECT_NEAR(two.ci95_high, 2.0 + 12.7062, 1e-3);  // Student's t with one degree of freedom
}

TEST(BootstrapMean, OfValuesNearlyAllEqualIsStudents) {
  const MeanInterval interval = BootstrapMean(std::vector<double>{0, 0, 0, 0, 1}, 1);
  const double half_width = 2.7764 * 0.2;  // t of 4 degrees of freedom, standard error 1/5
  EXPECT_NEAR(interval.ci95_low, 0.2 - half_width, 2e-3);
  EXPECT_NEAR(interval.ci95_high, 0.2 + half_width, 2e-3);
}

TEST(BootstrapMean, OfOneFarValueIsNoWiderThanTheValues) {
  // Delays of eight seeds in ms: the last one's true scatter is unknown, but no mean of such values
  // can lie thousands of milliseconds away.
  const std::vector<double> values{45.1, 45.0, 45.2, 44.9, 45.0, 45.1, 44.8, 175.0};
  const MeanInterval interval = BootstrapMean(values, 1);
  EXPECT_GT(interval.ci95_low, 61.2625 - 130.2);
  EXPECT_LT(interval.ci95_high, 61.2625 + 130.2);
  EXPECT_GT(interval.ci95_high - interval.ci95_low, 30.0);  // nor is it hidden
}

TEST(PairedDifference, IsNarrowWherePairsShareTheirDifficulty) {
  RandomStream random(8, "pairs");
  std::vector<double> first, second;
  for (int i = 0; i < 12; ++i) {
    const double shared = 10.0 * Normal(random);
    first.push_back(shared + 1.0 + 0.1 * Normal(random));
    second.push_back(shared);
  }
  first.push_back(kNaN);
  second.push_back(5.0);
  const MeanInterval difference = PairedDifference(first, second, 1);
  EXPECT_NEAR(difference.mean, 1.0, 0.1);
  EXPECT_GT(difference.ci95_low, 0.8);
  EXPECT_LT(difference.ci95_high, 1.2);
}

TEST(UnpairedDifference, CoversTheTruthOfGroupsOfOtherSizeAndScatter) {
  constexpr int kStudies = 2000;
  RandomStream random(5, "two groups");
  int covered = 0;
  for (int study = 0; study < kStudies; ++study) {
    std::vector<double> first(6), second(12);
    for (double& value : first) value = 2.0 + 3.0 * Normal(random);
    for (double& value : second) value = 1.0 + Normal(random);
    const MeanInterval interval = UnpairedDifference(first, second);
    covered += interval.ci95_low <= 1.0 && 1.0 <= interval.ci95_high;
  }
  EXPECT_GE(covered, 0.93 * kStudies);
  EXPECT_LE(covered, 0.97 * kStudies);
}

TEST(UnpairedDifference, OfEqualScattersIsStudentsTwoSampleTest) {
  // Means 2 and 5, variance 1 each: error sqrt(2 / 3), 4 degrees of freedom, t = 2.7764.
  const MeanInterval interval =
      UnpairedDifference(std::vector<double>{1, 2, 3}, std::vector<double>{4, 5, 6, kNaN});
  EXPECT_DOUBLE_EQ(interval.mean, -3.0);
  EXPECT_NEAR(interval.ci95_low, -3.0 - 2.7764 * std::sqrt(2.0 / 3.0), 0.01);
  EXPECT_NEAR(interval.ci95_high, -3.0 + 2.7764 * std::sqrt(2.0 / 3.0), 0.01);
}

TEST(UnpairedDifference, OfFewOrEqualValues) {
  const std::vector<double> one{2.0};
  const std::vector<double> equal{5.0, 5.0};
  EXPECT_EQ(UnpairedDifference(one, equal).mean, -3.0);
  EXPECT_TRUE(std::isnan(UnpairedDifference(one, equal).ci95_low));
  EXPECT_EQ(UnpairedDifference(equal, equal).ci95_low, 0.0);
  EXPECT_EQ(UnpairedDifference(equal, equal).ci95_high, 0.0);
  const MeanInterval wide = UnpairedDifference(std::vector<double>{0, 1}, equal);
  EXPECT_NEAR(wide.ci95_high, -4.5 + 12.7062 * 0.5, 1e-3);  // one degree of freedom
}

TEST(PairedEffectSize, IsTheMeanOverTheScatter) {
  const std::vector<double> first{3, 5, 7};
  const std::vector<double> second{2, 3, 4};
  EXPECT_DOUBLE_EQ(PairedEffectSize(first, second), 2.0);  // differences 1, 2, 3
  EXPECT_DOUBLE_EQ(PairedEffectSize(second, first), -2.0);
  EXPECT_TRUE(std::isnan(PairedEffectSize(first, first)));
}

TEST(Ranking, SharesPlacesAndLeavesOutWhatIsMissing) {
  const std::vector<double> values{2.0, 1.0, kNaN, 2.0, 5.0};
  EXPECT_EQ(Ranking(values, true), (std::vector<int>{2, 1, 0, 2, 4}));
  EXPECT_EQ(Ranking(values, false), (std::vector<int>{2, 4, 0, 2, 1}));
}

TEST(DominatedPoints, AreThoseBehindTheFront) {
  const std::vector<double> jitter{1.0, 2.0, 3.0, 2.5, 1.0, kNaN, 1.0};
  const std::vector<double> delay{9.0, 5.0, 1.0, 5.0, 9.0, 0.0, 9.5};
  EXPECT_EQ(DominatedPoints(jitter, delay),
            (std::vector<bool>{false, false, false, true, false, false, true}));
}

}  // namespace
}  // namespace gauntlet::sim
