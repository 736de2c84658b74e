// What the joint loop makes of a hand of cables, with every kind of servo: the table of
// docs/evidence/hand.md, held to limits.
#include <gtest/gtest.h>

#include "tests/loop/joint_loop_bench.h"

namespace gauntlet::sim::testing {
namespace {

constexpr double kSine_deg = 10.0;

class JointLoopOnAHand : public ::testing::TestWithParam<ServoKind> {};

TEST_P(JointLoopOnAHand, TakesHysteresisAwayWithoutALimitCycle) {
  const HandConfig hand = SensingHand(GetParam().defaults);
  const AtRest without = MeasureAtRest(hand, {});
  EXPECT_GT(without.hysteresis_deg.pip, 0.7);
  const controller::JointLoopConfig loop = FittedLoop(hand, without);
  const AtRest with = MeasureAtRest(hand, loop);
  EXPECT_LT(with.hysteresis_deg.mcp, 0.6);
  EXPECT_LT(with.hysteresis_deg.pip, 0.5);
  EXPECT_LT(with.error_deg.mcp, 0.6);
  EXPECT_LT(with.error_deg.pip, 0.5);
  EXPECT_LT(with.swing_deg.mcp, 0.1);
  EXPECT_LT(with.swing_deg.pip, 0.1);

  const OnASine late = MeasureOnASine(hand, {}, kSine_deg);
  EXPECT_GT(late.delay_ms.pip - late.delay_ms.mcp, 6.5);
  const OnASine mended = MeasureOnASine(hand, loop, kSine_deg);
  EXPECT_NEAR(mended.gain.mcp, 1.0, 0.03);
  EXPECT_NEAR(mended.gain.pip, 1.0, 0.04);
  EXPECT_NEAR(mended.delay_ms.pip, mended.delay_ms.mcp, 8.5);
}

INSTANTIATE_TEST_SUITE_P(Servos, JointLoopOnAHand, ::testing::ValuesIn(ServoKinds()),
                         [](const auto& servo) { return std::string(servo.param.name); });

}  // namespace
}  // namespace gauntlet::sim::testing
