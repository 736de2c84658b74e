#include "sim/score/mean_square_error.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <stdexcept>
#include <string>
#include <vector>

#include "sim/base/random.h"
#include "sim/score/scores_in_passing.h"

namespace gauntlet::sim {
namespace {

constexpr int kTicks = 1000;

using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Angles of a hand of some joints and of its wearer.
struct Angles {
  explicit Angles(int joints = 5) : hand(kTicks, joints), reference(kTicks, joints) {
    RandomStream random(1, "mean square error");
    for (Signal* signal : {&hand, &reference}) {
      for (double& value : signal->reshaped()) value = random.Uniform(-1.0, 1.0);
    }
  }
  Signal hand;
  Signal reference;
};

MeanSquareError InBlocks(int rows, const Angles& angles, const std::vector<int>& columns,
                         const std::vector<CountedTicks>& counted) {
  MeanSquareError error(columns, counted);
  for (int first = 0; first < kTicks; first += rows) {
    const int count = std::min(rows, kTicks - first);
    error.Add(angles.hand.middleRows(first, count), angles.reference.middleRows(first, count));
  }
  return error;
}

TEST(MeanSquareError, IsTheMeanOfTheTicksThatCount) {
  const Angles angles;
  const std::vector<int> columns = {3, 0, 4};
  const std::vector<CountedTicks> counted = {
      {{0, kTicks}}, {{10, 20}, {63, 65}, {500, kTicks}}, {{0, 64}}};
  const MeanSquareError error = InBlocks(64, angles, columns, counted);
  ASSERT_EQ(error.joint_count(), 3);
  for (int j = 0; j < 3; ++j) {
    double sum = 0.0;
    int count = 0;
    for (const TickRange& range : counted[j]) {
      for (int n = range.begin; n < range.end; ++n, ++count) {
        sum += std::pow(angles.hand(n, columns[j]) - angles.reference(n, columns[j]), 2);
      }
    }
    EXPECT_NEAR(error.Of(j), sum / count, 1e-14) << j;
  }
}

TEST(MeanSquareError, HasTheSameBitsInBlocksOfAnySize) {
  const Angles angles;
  const std::vector<int> columns = {0, 1, 2, 3, 4};
  const std::vector<CountedTicks> everywhere(5, {{0, kTicks}});
  const std::vector<CountedTicks> partly(5, {{0, 100}, {101, 650}, {700, kTicks}});
  for (const auto& counted : {everywhere, partly}) {
    const MeanSquareError whole = InBlocks(kTicks, angles, columns, counted);
    for (const int rows : {1, 7, 64, 999}) {
      const MeanSquareError error = InBlocks(rows, angles, columns, counted);
      for (const int j : columns) EXPECT_EQ(error.Of(j), whole.Of(j)) << rows;
    }
  }
}

TEST(MeanSquareError, HasTheSameBitsTickByTick) {
  const std::vector<CountedTicks> everywhere(3, {{0, kTicks}});
  const std::vector<CountedTicks> partly = {{{0, 100}, {101, 650}}, {}, {{64, kTicks}}};
  for (const int width : {5, 6, 8, 18, 23}) {
    Angles angles(width);
    const Rows hand = angles.hand;
    const Rows reference = angles.reference;
    angles.hand = angles.hand.cast<float>().cast<double>();  // as a trace keeps them
    for (const auto& columns : {std::vector<int>{0, 1, 2}, std::vector<int>{width - 1, 0, 3}}) {
      for (const auto& counted : {everywhere, partly}) {
        const MeanSquareError whole = InBlocks(kTicks, angles, columns, counted);
        MeanSquareError error(columns, counted);
        for (int first = 0; first < kTicks; first += 64) {
          const int count = std::min(64, kTicks - first);
          error.AddRows(hand.middleRows(first, count), reference.middleRows(first, count));
        }
        for (int j = 0; j < 3; ++j) {
          if (counted[j].empty()) {
            EXPECT_TRUE(std::isnan(error.Of(j)));
          } else {
            EXPECT_EQ(error.Of(j), whole.Of(j)) << j << " of " << width;
          }
        }
      }
    }
  }
}

TEST(MeanSquareError, TickByTickIsTheSameForEveryColumnOfManyColumns) {
  const Angles angles(18);
  std::vector<int> columns(18);
  std::iota(columns.begin(), columns.end(), 0);
  const std::vector<CountedTicks> everywhere(18, {{0, kTicks}});
  MeanSquareError error(columns, everywhere);
  for (int first = 0; first < kTicks; first += 100) {
    error.AddRows(Rows(angles.hand.middleRows(first, 100)),
                  Rows(angles.reference.middleRows(first, 100)));
  }
  for (const int j : columns) {
    double sum = 0.0;
    for (int n = 0; n < kTicks; ++n) {
      const double hand = static_cast<float>(angles.hand(n, j));
      sum += std::pow(hand - angles.reference(n, j), 2);
    }
    EXPECT_EQ(error.Of(j), sum / kTicks) << j;
  }
}

TEST(MeanSquareError, OfNoTicksIsNoNumber) {
  const MeanSquareError error = InBlocks(64, Angles(), {0}, {{}});
  EXPECT_TRUE(std::isnan(error.Of(0)));
}

const std::vector<std::string> kJoints = {"first", "second", "third", "fourth", "fifth"};

TEST(ScoresInPassing, AreThoseOfTheSignals) {
  const Angles angles;
  const ScoreRows rows(kJoints, {}, {});
  const std::size_t metrics[] = {MetricIndex("tracking_rmse_deg")};
  CountedParts parts;
  parts.joints.assign(5, {{0, 300}, {400, kTicks}});
  parts.joints[2] = {};
  const Scores whole = ComputeScores(
      {.reference_angle_rad = &angles.reference, .hand_angle_rad = &angles.hand, .counted = &parts},
      rows, metrics);
  const MeanSquareError error = InBlocks(64, angles, {0, 1, 2, 3, 4}, parts.joints);
  const Scores passing = ScoresInPassing(error, rows, metrics);
  EXPECT_EQ(passing.summary[metrics[0]], whole.summary[metrics[0]]);
  EXPECT_GT(passing.summary[metrics[0]], 10.0);
  for (std::size_t j = 0; j < 5; ++j) {
    const double score = passing.channels[j][metrics[0]];
    if (j == 2) {
      EXPECT_TRUE(std::isnan(score));
    } else {
      EXPECT_EQ(score, whole.channels[j][metrics[0]]);
    }
  }
  EXPECT_TRUE(std::isnan(passing.summary[MetricIndex("delay_ms")]));
}

TEST(ScoresInPassing, RefuseWhatNeedsSignals) {
  const std::size_t tracking = MetricIndex("tracking_rmse_deg");
  const std::size_t both[] = {tracking, MetricIndex("peak_error_deg")};
  EXPECT_TRUE(AreInPassing(std::vector{tracking}));
  EXPECT_FALSE(AreInPassing(both));
  EXPECT_FALSE(AreInPassing({}));  // all
  const MeanSquareError error =
      InBlocks(64, Angles(), {0, 1, 2, 3, 4}, std::vector<CountedTicks>(5, {{0, kTicks}}));
  EXPECT_THROW(ScoresInPassing(error, ScoreRows(kJoints, {}, {}), both), std::invalid_argument);
  EXPECT_THROW(ScoresInPassing(error, ScoreRows({}, {}, {}), {&tracking, 1}),
               std::invalid_argument);
}

}  // namespace
}  // namespace gauntlet::sim
