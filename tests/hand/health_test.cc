#include <gmock/gmock.h>

#include "tests/hand/hand_fixture.h"
#include "tests/hand/small_hand.h"

namespace gauntlet::sim::testing {
namespace {

using ::testing::ContainsRegex;

TEST(Health, ADivergingHandStopsAndSaysWhenAndWhy) {
  Hand hand(MakeDivergingHand("index_mcp"));
  StepTimes(hand, 10);
  EXPECT_TRUE(hand.health().ok) << hand.health().problem;
  StepTimes(hand, 100);
  EXPECT_FALSE(hand.health().ok);
  EXPECT_THAT(hand.health().problem, ContainsRegex("at 0\\.01[5-9] s: .*Q"));

  const double stopped_s = hand.data().time;
  const std::string problem = hand.health().problem;
  StepTimes(hand, 10);
  EXPECT_EQ(hand.data().time, stopped_s) << "a hand that is not well does not go on";
  EXPECT_EQ(hand.health().problem, problem);

  hand.Reset(std::vector<double>{0.0});
  StepTimes(hand, 10);
  EXPECT_TRUE(hand.health().ok);
}

}  // namespace
}  // namespace gauntlet::sim::testing
