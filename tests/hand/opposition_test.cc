#include "tests/hand/opposition.h"

#include <gtest/gtest.h>

namespace gauntlet::sim::testing {
namespace {

// Pads meet nearly flat on each other, and no digit is in another.
TEST(Thumb, MeetsEveryFingerPadToPad) {
  Hand hand(MakeModel());
  for (const Opposition& posture : kOppositions) {
    const Meeting meeting = Meet(hand, posture);
    EXPECT_LT(meeting.gap_mm, posture.kapandji == 1 ? 1.5 : 0.5) << posture.finger;
    EXPECT_LT(meeting.facing_deg, 26.0) << posture.finger;
    EXPECT_LT(meeting.overlap_mm, 0.1) << posture.finger;
  }
}

// The postures lie in the ranges of the joints, with the channels' own names.
TEST(Thumb, ReachesThePosturesOfOppositionByItsMotors) {
  Hand hand(MakeModel(FrictionFree()));
  const controller::TendonTransmission& map = hand.hand_model().transmission();
  for (const Opposition& posture : kOppositions) {
    std::vector<double> angle_rad(map.joint_names.size(), 0.0);
    hand.Reset(angle_rad);
    const char* const thumb[] = {"thumb_rotation", "thumb_abduction", "thumb_mcp", "thumb_ip"};
    for (std::size_t i = 0; i < 4; ++i) {
      const auto channel = static_cast<std::size_t>(ChannelIndex(thumb[i]));
      angle_rad[channel] = posture.thumb_deg[i] * kRadPerDeg;
      EXPECT_GE(angle_rad[channel], map.joint_min_rad[channel] - 1e-9);
      EXPECT_LE(angle_rad[channel], map.joint_max_rad[channel] + 1e-9);
    }
    hand.SetCommand(CountsFor(map, angle_rad));
    StepTimes(hand, 2000);
    for (std::size_t i = 0; i < 4; ++i) {
      const auto channel = static_cast<std::size_t>(ChannelIndex(thumb[i]));
      EXPECT_NEAR(JointAngles(hand)[channel] * kDegPerRad, posture.thumb_deg[i], 1.0) << thumb[i];
    }
  }
}

}  // namespace
}  // namespace gauntlet::sim::testing
