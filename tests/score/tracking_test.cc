#include "sim/score/tracking.h"

#include <gtest/gtest.h>

#include "tests/score/signals.h"

namespace gauntlet::sim {
namespace {

TEST(Tracking, RmsAndPeakOfKnownDifferences) {
  const std::vector<double> reference{1, 1, 1, 1};
  const std::vector<double> hand{2, 0, 1, -3};
  std::vector<double> error;
  for (std::size_t n = 0; n < hand.size(); ++n) error.push_back(hand[n] - reference[n]);
  EXPECT_DOUBLE_EQ(RmsWithin(error, 0, All(error)), std::sqrt(18.0 / 4.0));
  EXPECT_DOUBLE_EQ(PeakWithin(error, All(error)), 4.0);
  EXPECT_DOUBLE_EQ(Rms(hand), std::sqrt(14.0 / 4.0));
  EXPECT_DOUBLE_EQ(RmsWithin(error, 0, {{0, 1}, {2, 3}}), std::sqrt(1.0 / 2.0));
  EXPECT_DOUBLE_EQ(PeakWithin(error, {{0, 1}, {2, 3}}), 1.0);
  EXPECT_TRUE(std::isnan(RmsWithin(error, 0, {})));
  EXPECT_TRUE(std::isnan(PeakWithin(error, {})));
}

double ReversalsPerSecond(const std::vector<int>& command, double rate_hz) {
  return ReversalsPerSecond(command, rate_hz, All(command));
}

TEST(CommandReversals, CountTurnsAndNotSteps) {
  EXPECT_DOUBLE_EQ(ReversalsPerSecond(std::vector{0, 1, 2, 3, 4, 4, 5, 9, 9, 10}, 10.0), 0.0);
  EXPECT_DOUBLE_EQ(ReversalsPerSecond(std::vector{5, 6, 5, 6, 5, 5, 5, 6, 7, 8}, 10.0), 4.0);
  EXPECT_DOUBLE_EQ(ReversalsPerSecond(std::vector{5, 5, 5, 5}, 10.0), 0.0);
  // Up, then down: no turn within either range.
  EXPECT_DOUBLE_EQ(sim::ReversalsPerSecond(std::vector{1, 2, 3, 2, 1}, 10.0, {{0, 3}, {3, 5}}),
                   0.0);
}

TEST(CommandReversals, DoNotDependOnHowLongAFrameIsHeld) {
  const std::vector<int> frames{3, 4, 7, 6, 6, 9, 2, 2, 5, 4};
  std::vector<int> held;
  for (const int frame : frames) held.insert(held.end(), 20, frame);
  EXPECT_DOUBLE_EQ(ReversalsPerSecond(frames, 50.0), ReversalsPerSecond(held, 1000.0));
}

}  // namespace
}  // namespace gauntlet::sim
