// Where the hand is when the controller starts, and after Reset().

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <utility>

#include "controller/controller.h"
#include "tests/controller/test_hand.h"
#include "tests/controller/test_signal.h"

namespace gauntlet::controller {
namespace {

using testing::ElementsAre;
using testing::ElementsAreArray;

constexpr int kChannels = 3;
/// 20 rad/s at 100 counts per rad and an event of 20 ms.
constexpr int kCountsPerEvent = 40;

Controller Make(const Timing& timing = {}) {
  ControllerConfig config;
  config.filters = {{KalmanConfig{.noise = {.r = {15.0}}}}};
  return Controller(config, PlainGlove(kChannels), CoupledHand(kChannels), timing);
}

/// The largest change of a command, the first one held against `last`.
int LargestChange(Controller& controller, const std::vector<double>& counts,
                  std::vector<std::int32_t> last, int samples) {
  int largest = 0;
  for (int k = 0; k < samples; ++k) {
    const auto now = controller.Step({.counts = counts}).motor_counts;
    for (std::size_t i = 0; i < now.size(); ++i) {
      largest = std::max(largest, std::abs(now[i] - last[i]));
    }
    last.assign(now.begin(), now.end());
  }
  return largest;
}

TEST(Start, IsWithinTheSpeedLimitFromTheReferencePosture) {
  Controller controller = Make();
  const std::vector<double> closed(kChannels, 700.0);
  EXPECT_LE(LargestChange(controller, closed, {512, 512, 512}, 400), kCountsPerEvent + 1);
  EXPECT_THAT(controller.Step().motor_counts, ElementsAre(637, 687, 687));  // 1.25 rad
}

TEST(Start, IsWithinTheSpeedLimitFromWhereTheCallerSaysThatTheHandIs) {
  Controller controller = Make();
  controller.Reset(std::vector<std::int32_t>{612, 652, 652});  // 1 rad
  // Before the first good value every joint stays where it is.
  const std::vector<double> nothing(kChannels, std::numeric_limits<double>::quiet_NaN());
  EXPECT_EQ(LargestChange(controller, nothing, {612, 652, 652}, 100), 0);
  EXPECT_NEAR(controller.target_angle_rad()[1], 1.0, 1e-12);
  const std::vector<double> open(kChannels, 400.0);
  EXPECT_LE(LargestChange(controller, open, {612, 652, 652}, 400), kCountsPerEvent + 1);
  EXPECT_THAT(controller.Step().motor_counts, ElementsAre(562, 582, 582));
}

TEST(Start, DoesNotMoveForAGlitchInTheVeryFirstSample) {
  for (const double glitch : {0.5, 20.0, 590.0, 1000.0, 1022.9}) {
    Controller controller = Make({.event_period_ms = 1.0});
    controller.Reset(std::vector<std::int32_t>{522, 526, 526});  // 0.1 rad, 240 counts
    const std::vector<double> still(kChannels, 240.0);
    std::vector<double> first = still;
    if (std::abs(glitch - 240.0) > 255.0) first[1] = glitch;
    EXPECT_EQ(LargestChange(controller, first, {522, 526, 526}, 1), 0) << glitch;
    EXPECT_EQ(LargestChange(controller, still, {522, 526, 526}, 50), 0) << glitch;
  }
}

TEST(Start, FollowsAGloveThatIsFarFromTheHandOnceThatIsSure) {
  Controller controller = Make({.event_period_ms = 1.0});
  const std::vector<double> closed(kChannels, 700.0);  // 500 counts from the reference
  for (int k = 0; k < 10; ++k) controller.Step({.counts = closed});
  EXPECT_EQ(controller.filtered_angle_rad()[0], 0.0);
  EXPECT_EQ(controller.untrusted_samples(Untrusted::kJumped)[0], 10);
  controller.Step({.counts = closed});
  EXPECT_NEAR(controller.filtered_angle_rad()[0], 1.25, 1e-12);
}

TEST(Reset, DoesNotMoveTheHand) {
  Controller controller = Make();
  const std::vector<double> bent(kChannels, 440.0);
  for (int k = 0; k < 400; ++k) controller.Step({.counts = bent});
  const auto motors = controller.Step().motor_counts;
  const std::vector<std::int32_t> there(motors.begin(), motors.end());
  controller.Reset();
  EXPECT_THAT(motors, ElementsAreArray(there));
  EXPECT_EQ(controller.untrusted_samples()[0], 0);
  const std::vector<double> nothing(kChannels, std::numeric_limits<double>::quiet_NaN());
  EXPECT_EQ(LargestChange(controller, nothing, there, 100), 0);
  EXPECT_NEAR(controller.target_angle_rad()[1], 0.6, 1e-12);
}

TEST(Reset, LeavesChannelsOffThatAreOff) {
  Controller controller = Make();
  const std::vector<double> bent(kChannels, 440.0);
  for (int k = 0; k < 400; ++k) controller.Step({.counts = bent});
  controller.SetChannelActive(1, false);
  controller.Reset();
  EXPECT_FALSE(controller.channel_active(1));
  const std::vector<double> other(kChannels, 600.0);
  for (int k = 0; k < 400; ++k) controller.Step({.counts = other});
  EXPECT_NEAR(controller.target_angle_rad()[0], 1.0, 1e-12);
  EXPECT_NEAR(controller.target_angle_rad()[1], 0.6, 1e-12);  // where it was
  controller.Reset(std::vector<std::int32_t>{512, 512, 512});
  for (int k = 0; k < 400; ++k) controller.Step({.counts = bent});
  EXPECT_NEAR(controller.target_angle_rad()[0], 0.6, 1e-12);
  EXPECT_NEAR(controller.target_angle_rad()[1], 0.0, 1e-12);  // where the caller says
}

TEST(Command, SaysAtWhichTicksAFrameIsDue) {
  Controller controller = Make();
  const std::vector<double> bent(kChannels, 440.0);
  for (int k = 0; k < 100; ++k) EXPECT_EQ(controller.Step({.counts = bent}).event, k % 20 == 0);
  controller.Reset();
  EXPECT_TRUE(controller.Step({.counts = bent}).event);
}

TEST(Controller, IgnoresChannelsThatThereAreNot) {
  Controller controller = Make();
  for (const int channel : {-1, kChannels, 9999, std::numeric_limits<int>::min()}) {
    controller.SetChannelActive(channel, false);
    controller.SetChannelActive(channel, true);
    EXPECT_FALSE(controller.channel_active(channel));
  }
  for (int channel = 0; channel < kChannels; ++channel) {
    EXPECT_TRUE(controller.channel_active(channel));
  }
  EXPECT_TRUE(controller.untrusted_samples(static_cast<Untrusted>(kUntrustedKinds)).empty());
}

TEST(Controller, ReadsNoMoreOfASampleThanThereAreChannels) {
  Controller controller = Make();
  const std::vector<double> longer(50, 440.0);
  for (int k = 0; k < 400; ++k) controller.Step({.counts = longer});
  EXPECT_THAT(controller.target_angle_rad(),
              testing::Pointwise(testing::DoubleNear(1e-12), {0.6, 0.6, 0.6}));
  controller.Reset(std::vector<std::int32_t>{1, 2});  // not one per motor: the hand stays
  EXPECT_NEAR(controller.target_angle_rad()[2], 0.6, 1e-12);
}

TEST(Controller, GivesEmptyCommandsWhenItWasMovedFrom) {
  Controller controller = Make();
  Controller taken = std::move(controller);
  const std::vector<double> bent(kChannels, 440.0);
  // NOLINTBEGIN: what is moved from is looked at on purpose
  EXPECT_TRUE(controller.Step({.counts = bent}).motor_counts.empty());
  EXPECT_FALSE(controller.Step().event);
  EXPECT_EQ(controller.channel_count() + controller.joint_count() + controller.motor_count(), 0);
  EXPECT_TRUE(controller.target_angle_rad().empty());
  EXPECT_TRUE(controller.untrusted_samples().empty());
  controller.SetChannelActive(0, false);
  controller.Reset();
  EXPECT_THROW(controller.Load({}), SettingError);
  controller = std::move(taken);
  // NOLINTEND
  EXPECT_EQ(controller.Step({.counts = bent}).motor_counts.size(), 3u);
}

std::string ProblemOf(const GloveCalibration& glove, const TendonTransmission& hand,
                      const JointMapConfig& joint_map = {}) {
  try {
    const Controller controller({}, glove, hand, {}, joint_map);
  } catch (const SettingError& error) {
    return error.what();
  }
  return "";
}

TEST(Controller, RefusesWhatCannotBe) {
  const GloveCalibration glove = PlainGlove(kChannels);
  const TendonTransmission hand = CoupledHand(kChannels);
  EXPECT_EQ(ProblemOf(glove, hand), "");

  GloveCalibration wrong_glove = glove;
  wrong_glove.channel_names[2] = "joint_0";
  EXPECT_EQ(ProblemOf(wrong_glove, hand), "calibration.channel_names: joint_0 appears twice");
  wrong_glove = glove;
  wrong_glove.low_counts[1] = 5000.0;
  EXPECT_EQ(ProblemOf(wrong_glove, hand),
            "calibration: channel joint_1: a pose is at 5000 counts, must be within the "
            "converter's range, 0 to 1023");
  wrong_glove = glove;
  wrong_glove.high_counts[1] = 202.0;
  EXPECT_EQ(ProblemOf(wrong_glove, hand),
            "calibration: channel joint_1: the two poses are 2 counts apart, must be at least 10, "
            "or rounding to whole counts decides the angles");
  wrong_glove = glove;
  wrong_glove.frame_number_bits = 65;
  EXPECT_EQ(ProblemOf(wrong_glove, hand),
            "calibration.frame_number_bits: is 65, must be from 2 to 64");

  TendonTransmission wrong_hand = hand;
  wrong_hand.joint_names[2] = "joint_1";
  EXPECT_EQ(ProblemOf(glove, wrong_hand), "transmission.joint_names: joint_1 appears twice");
  wrong_hand = hand;
  wrong_hand.motor_names[2] = "motor_1";
  EXPECT_EQ(ProblemOf(glove, wrong_hand), "transmission.motor_names: motor_1 appears twice");
  wrong_hand = hand;
  wrong_hand.reference_angle_rad[2] = 1.6;
  EXPECT_EQ(ProblemOf(glove, wrong_hand),
            "transmission.reference_angle_rad: joint joint_2: is 1.6, must be within the joint's "
            "range, 0 to 1.5");

  const JointSource source = {.joint = "joint_1", .channels = {"joint_0"}};
  EXPECT_EQ(ProblemOf(glove, hand, {.joints = {source, source}}),
            "joint_map.joint_1: appears twice");
}

}  // namespace
}  // namespace gauntlet::controller
