#include "controller/joint_map.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>

#include "tests/controller/test_hand.h"

namespace gauntlet::controller {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

constexpr double kRadPerDeg = std::numbers::pi / 180.0;
const std::vector<std::string> kChannels = {"joint_1", "thumb", "joint_0"};

std::vector<double> JointsOf(const JointMap& map, std::vector<double> channel_rad) {
  std::vector<double> joint_rad(static_cast<std::size_t>(map.joint_count()));
  map.ToJoints(channel_rad, joint_rad);
  return joint_rad;
}

TEST(JointMap, CopiesTheChannelOfTheSameNameBitByBit) {
  const JointMap map({}, kChannels, CoupledHand(2));
  EXPECT_THAT(JointsOf(map, {0.1, 0.2, 1.0 / 3.0}), ElementsAre(1.0 / 3.0, 0.1));
}

TEST(JointMap, HoldsWhatNoChannelMeasuresAtTheReference) {
  TendonTransmission hand = CoupledHand(4);
  hand.reference_angle_rad = {0.1, 0.2, 0.3, 0.4};
  const JointMap map({}, kChannels, hand);
  EXPECT_THAT(JointsOf(map, {1.1, 1.2, 1.3}), ElementsAre(1.3, 1.1, 0.3, 0.4));
  EXPECT_TRUE(map.measured(1));
  EXPECT_FALSE(map.measured(2));
}

TEST(JointMap, AddsUpASynergyAndHoldsAConstantPosture) {
  const JointMapConfig config = {
      .joints = {{.joint = "joint_1",
                  .channels = {"thumb", "joint_0"},
                  .weights = {0.5, -2.0},
                  .offset_deg = 90.0},
                 {.joint = "joint_0", .channels = {}, .offset_deg = 45.0}}};
  const JointMap map(config, kChannels, CoupledHand(2));
  const std::vector<double> joints = JointsOf(map, {9.0, 0.4, 0.1});
  EXPECT_DOUBLE_EQ(joints[0], 45.0 * kRadPerDeg);
  EXPECT_DOUBLE_EQ(joints[1], 90.0 * kRadPerDeg + 0.5 * 0.4 - 2.0 * 0.1);
  EXPECT_FALSE(map.measured(0));
}

TEST(JointMap, FindsThePostureOfTheGloveForThatOfTheHand) {
  const JointMapConfig config = {
      .joints = {{.joint = "joint_1", .channels = {"thumb"}, .weights = {2.0}, .offset_deg = 0.0}}};
  const JointMap map(config, kChannels, CoupledHand(2));
  std::vector<double> channels = {7.0, 7.0, 7.0};
  map.ToChannels(std::vector<double>{0.3, 0.8}, channels);
  EXPECT_THAT(channels, ElementsAre(7.0, 0.4, 0.3));
}

TEST(JointMap, SaysWhatIsWrong) {
  const auto problem_of = [](const JointSource& source) -> std::string {
    try {
      JointMap({.joints = {source}}, kChannels, CoupledHand(2));
    } catch (const SettingError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_THAT(problem_of({.joint = "tail", .channels = {}}),
              HasSubstr("tail: is not a joint of the hand, which has joint_0, joint_1"));
  EXPECT_THAT(problem_of({.joint = "joint_0", .channels = {"toe"}}),
              HasSubstr("joint_0.channels: toe is not a channel of the glove"));
  EXPECT_THAT(problem_of({.joint = "joint_0", .channels = {"thumb"}, .weights = {1.0, 2.0}}),
              HasSubstr("joint_0.weights: has 2 values, must have 1"));
  // Weights that cancel each other would count as measured.
  EXPECT_THAT(
      problem_of(
          {.joint = "joint_0", .channels = {"thumb", "joint_1", "thumb"}, .weights = {1, 1, -1}}),
      HasSubstr("joint_0.channels: has thumb twice, must have it once"));
  EXPECT_THAT(problem_of({.joint = "joint_1", .channels = {}, .offset_deg = 86.0}),
              HasSubstr("joint_1.offset_deg: holds the joint at 86, must be in its range of 0 to "
                        "85.94"));
  EXPECT_THAT(problem_of({.joint = "joint_1", .channels = {}, .offset_deg = -1.0}),
              HasSubstr("holds the joint at -1"));
}

TEST(JointMap, HoldsAJointAtTheEndsOfItsRange) {
  for (const double end_rad : {0.0, 1.5}) {
    const JointMapConfig config = {
        .joints = {{.joint = "joint_1", .channels = {}, .offset_deg = end_rad / kRadPerDeg}}};
    const JointMap map(config, kChannels, CoupledHand(2));
    EXPECT_NEAR(JointsOf(map, {0.1, 0.2, 0.3})[1], end_rad, 1e-12);
  }
}

}  // namespace
}  // namespace gauntlet::controller
