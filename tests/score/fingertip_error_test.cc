#include "sim/score/fingertip_error.h"

#include <gtest/gtest.h>

#include "tests/score/signals.h"

namespace gauntlet::sim {
namespace {

constexpr int kRows = 100;
const CountedTicks kAll = {{0, 10 * kRows}};

/// Thumb, index and middle fingertip, 20 and 45 mm from the thumb, which all move together.
struct Example {
  Signal reference = Signal::Zero(kRows, 9);
  Signal hand = Signal::Zero(kRows, 9);

  Example() {
    for (int row = 0; row < kRows; ++row) {
      const Eigen::RowVector3d thumb(0.05 + 1e-4 * row, 0.01, -0.02);
      reference.row(row) << thumb, thumb + Eigen::RowVector3d(0.0, 0.02, 0.0),
          thumb + Eigen::RowVector3d(0.0, 0.0, 0.045);
    }
    hand = reference;
  }
  FingertipSignals Signals() const {
    return {.hand_m = &hand,
            .reference_m = &reference,
            .ticks_per_row = 10,
            .measured = {0, 1, 2},
            .pinches = {{0, 1}, {0, 2}}};
  }
};

TEST(FingertipError, OfARigidShiftIsItsLength) {
  Example example;
  EXPECT_EQ(FingertipError(example.Signals(), kAll), 0.0);
  for (int tip = 0; tip < 3; ++tip) {
    example.hand.middleCols(3 * tip, 3).rowwise() += Eigen::RowVector3d(0.001, -0.002, 0.002);
  }
  EXPECT_NEAR(FingertipError(example.Signals(), kAll), 0.003, 1e-15);
  EXPECT_NEAR(PinchDistanceError(example.Signals(), kAll), 0.0, 1e-15);
}

TEST(FingertipError, IsTheRmsOverMeasuredTipsAndTime) {
  Example example;
  example.hand.col(3).array() += 0.003;  // the index finger alone
  EXPECT_NEAR(FingertipError(example.Signals(), kAll), 0.003 / std::sqrt(3.0), 1e-15);
  FingertipSignals index_alone = example.Signals();
  index_alone.measured = {1};
  EXPECT_NEAR(FingertipError(index_alone, kAll), 0.003, 1e-15);
  example.hand.block(0, 3, kRows / 4, 1) = example.reference.block(0, 3, kRows / 4, 1);
  EXPECT_NEAR(FingertipError(index_alone, kAll), 0.003 * std::sqrt(0.75), 1e-15);
  index_alone.measured = {};
  EXPECT_TRUE(std::isnan(FingertipError(index_alone, kAll)));
}

TEST(PinchDistanceError, IsOfTheDistanceWhereTheReferencePinches) {
  Example example;
  example.hand.col(4).array() += 0.002;  // 22 mm from the thumb in place of 20
  example.hand.col(8).array() += 0.009;  // 54 mm in place of 45: no pinch
  EXPECT_NEAR(PinchDistanceError(example.Signals(), kAll), 0.002, 1e-15);
  example.reference.col(8).array() -= 0.0051;  // 39.9 mm: a pinch
  EXPECT_NEAR(PinchDistanceError(example.Signals(), kAll),
              std::sqrt((0.002 * 0.002 + 0.0141 * 0.0141) / 2.0), 1e-12);
}

TEST(PinchDistanceError, DoesNotExistWithoutAPinchOfTheReference) {
  Example example;
  example.reference.col(4).array() += 0.025;  // while the hand pinches
  EXPECT_TRUE(std::isnan(PinchDistanceError(example.Signals(), kAll)));
}

TEST(FingertipScores, LookAtRowsWhoseTickCounts) {
  Example example;
  example.hand(30, 0) += 1.0;  // tick 300
  EXPECT_GT(FingertipError(example.Signals(), kAll), 0.0);
  EXPECT_EQ(FingertipError(example.Signals(), {{0, 300}, {301, 1000}}), 0.0);
  EXPECT_NEAR(FingertipError(example.Signals(), {{291, 305}}), 1.0 / std::sqrt(3.0), 1e-12);
  EXPECT_TRUE(std::isnan(FingertipError(example.Signals(), {{301, 310}})));
}

}  // namespace
}  // namespace gauntlet::sim
