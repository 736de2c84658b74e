#include "sim/score/mean_square_error.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "sim/base/random.h"
#include "sim/base/signal.h"
#include "sim/score/score.h"

namespace gauntlet::sim {
namespace {

constexpr int kTicks = 1000;

using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Angles of a hand of some joints, as exact as a trace keeps them, and of its wearer.
struct Angles {
  explicit Angles(int joints = 5) : hand(kTicks, joints), reference(kTicks, joints) {
    RandomStream random(1, "mean square error");
    for (Signal* signal : {&hand, &reference}) {
      for (double& value : signal->reshaped()) value = random.Uniform(-1.0, 1.0);
    }
    hand = hand.cast<float>().cast<double>();
  }
  Signal hand;
  Signal reference;
};

std::vector<double> InBlocks(int rows, const Angles& angles, const std::vector<int>& joints,
                             const std::vector<CountedTicks>& counted) {
  MeanSquareError error(joints, counted);
  for (int first = 0; first < kTicks; first += rows) {
    const int count = std::min(rows, kTicks - first);
    error.Add(Rows(angles.hand.middleRows(first, count)),
              Rows(angles.reference.middleRows(first, count)));
  }
  return error.Values();
}

TEST(MeanSquareError, IsTheMeanOfTheTicksThatCount) {
  const Angles angles;
  const std::vector<int> joints = {3, 0, 4};
  const std::vector<CountedTicks> counted = {
      {{0, kTicks}}, {{10, 20}, {63, 65}, {500, kTicks}}, {{0, 64}}};
  const std::vector<double> errors = InBlocks(64, angles, joints, counted);
  ASSERT_EQ(errors.size(), 3);
  for (int j = 0; j < 3; ++j) {
    double sum = 0.0;
    int count = 0;
    for (const TickRange& range : counted[j]) {
      for (int n = range.begin; n < range.end; ++n, ++count) {
        const double error = angles.hand(n, joints[j]) - angles.reference(n, joints[j]);
        sum += error * error;
      }
    }
    EXPECT_EQ(errors[j], sum / count) << j;
  }
}

TEST(MeanSquareError, HasTheSameBitsInBlocksOfAnySize) {
  const std::vector<CountedTicks> everywhere(3, {{0, kTicks}});
  const std::vector<CountedTicks> partly = {
      {{0, 100}, {101, 650}}, {{700, 701}}, {{64, 65}, {66, kTicks}}};
  for (const int width : {5, 6, 8, 18, 23}) {
    const Angles angles(width);
    for (const auto& joints : {std::vector<int>{0, 1, 2}, std::vector<int>{width - 1, 0, 3}}) {
      for (const auto& counted : {everywhere, partly}) {
        const std::vector<double> whole = InBlocks(kTicks, angles, joints, counted);
        for (const int rows : {1, 7, 64, 999}) {
          EXPECT_EQ(InBlocks(rows, angles, joints, counted), whole) << rows << " of " << width;
        }
      }
    }
  }
}

TEST(MeanSquareError, RoundsTheHandsAnglesAsATraceKeepsThem) {
  MeanSquareError error({0}, {{{0, 1}}});
  error.Add(Rows::Constant(1, 1, 0.1), Rows::Constant(1, 1, 0.0));
  const double kept = 0.1F;
  EXPECT_EQ(error.Values()[0], kept * kept);
}

TEST(MeanSquareError, OfNoTicksIsNoNumber) {
  EXPECT_TRUE(std::isnan(InBlocks(64, Angles(), {0}, {{}})[0]));
}

TEST(TrackingScores, AreThoseOfTheSignals) {
  const Angles angles;
  const std::vector<std::string> joints = {"first", "second", "third", "fourth", "fifth"};
  const ScoreRows rows(joints, {}, {});
  const std::size_t metrics[] = {MetricIndex("tracking_rmse_deg")};
  CountedParts parts;
  parts.joints.assign(5, {{0, 300}, {400, kTicks}});
  parts.joints[2] = {};
  const Scores whole = ComputeScores(
      {.reference_angle_rad = &angles.reference, .hand_angle_rad = &angles.hand, .counted = &parts},
      rows, metrics);
  const Scores passing = TrackingScores(InBlocks(64, angles, {0, 1, 2, 3, 4}, parts.joints), rows);
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

}  // namespace
}  // namespace gauntlet::sim
