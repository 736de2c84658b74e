#include <gmock/gmock.h>
#include <sys/stat.h>

#include <filesystem>
#include <fstream>
#include <functional>

#include "sim/base/error.h"
#include "tests/hand/hand_fixture.h"
#include "tests/hand/small_hand.h"
#include "tests/support/program.h"

namespace gauntlet::sim::testing {
namespace {

using ::testing::ContainsRegex;
using ::testing::HasSubstr;

/// The message with which a hand of these settings is refused; empty if it is not.
std::string Refusal(const std::function<void(HandConfig&)>& change) {
  HandConfig config;
  change(config);
  try {
    MakeModel(config);
  } catch (const UserError& error) {
    return error.what();
  } catch (const controller::SettingError& error) {
    return error.what();
  }
  return "";
}

TEST(HandSettings, NumbersOutOfRangeAreRefusedByName) {
  EXPECT_THAT(Refusal([](HandConfig& c) { c.cable.stiffness_scale = -1; }),
              HasSubstr("cable.stiffness_scale"));
  EXPECT_THAT(Refusal([](HandConfig& c) { c.cable.pretension_mm = -0.1; }),
              HasSubstr("cable.pretension_mm"));
  EXPECT_THAT(Refusal([](HandConfig& c) { c.servo.numbers().no_load_speed_deg_s = 0; }),
              HasSubstr("servo.no_load_speed_deg_s"));
  EXPECT_THAT(Refusal([](HandConfig& c) { c.servo.numbers().resolution_bits = 3; }),
              HasSubstr("servo.resolution_bits"));
}

TEST(HandSettings, ATravelThatTheSpoolCannotWindIsRefused) {
  const std::string message = Refusal([](HandConfig& c) { c.servo.numbers().travel_deg = 200; });
  EXPECT_THAT(message, HasSubstr("hand.servo.travel_deg"));
  EXPECT_THAT(message, HasSubstr("must wind"));
}

TEST(HandSettings, ACurrentLimitThatTheServoCannotHaveIsRefused) {
  EXPECT_EQ(Refusal([](HandConfig& c) { c.servo.numbers().current_limit_ma = 1470; }), "");
  EXPECT_EQ(Refusal([](HandConfig& c) { c.servo.numbers().current_limit_ma = 1471; }),
            "hand.servo.current_limit_ma: is 1471, must be at most stall_current_ma, 1470");
  EXPECT_THAT(Refusal([](HandConfig& c) { c.arm_servo.numbers().current_limit_ma = 100; }),
              HasSubstr("hand.arm_servo.current_limit_ma: is 100, but stall_current_ma"));
}

TEST(HandSettings, ListsAreOfOneForAllMotorsOrOneForEach) {
  EXPECT_EQ(Refusal([](HandConfig& c) { c.cable.slack_mm = std::vector<double>(18, 0.1); }), "");
  EXPECT_EQ(Refusal([](HandConfig& c) {
              c.cable.slack_mm = {0.1, 0.2};
            }),
            "hand.cable.slack_mm: has 2 values, must have 1 for all motors or 18, one for each");
  EXPECT_THAT(Refusal([](HandConfig& c) { c.cable.slack_mm = {}; }),
              HasSubstr("hand.cable.slack_mm: has 0 values"));
}

TEST(HandSettings, StepsAreShortenedUntilWholeOnesMakeUpATick) {
  HandConfig config;
  config.step_ms = 0.3;
  EXPECT_DOUBLE_EQ(HandModel(config).model().opt.timestep, 0.25e-3);
  const LoopTiming of_a_slow_glove = MakeLoopTiming({.sample_rate_hz = 33.3});
  EXPECT_DOUBLE_EQ(HandModel({}, of_a_slow_glove).model().opt.timestep, 1.0 / (31 * 33.3));
}

TEST(HandSettings, WhatTheTimeStepCannotBearIsRefused) {
  const auto strongly_damped = [](HandConfig& c) {
    c.servo.settings = StandardServo{};
    c.servo.numbers().damping_ms = 100;
  };
  EXPECT_THAT(Refusal(strongly_damped), HasSubstr("hand.servo: the servo of thumb_rotation"));
  const auto far_too_stiff = [](HandConfig& c) {
    c.servo.settings = StandardServo{};
    c.servo.numbers().inertia_scale = 0.1;
    c.cable.stiffness_scale = 10.0;
  };
  EXPECT_THAT(Refusal(far_too_stiff), HasSubstr("too stiff for hand.step_ms 1"));
  EXPECT_EQ(Refusal([&](HandConfig& c) { c.cable.stiffness_scale = 8.0; }), "");
}

TEST(HandSettings, AMissingModelIsNamed) {
  EXPECT_THAT(Refusal([](HandConfig& c) { c.model_path = "/nowhere/hand.xml"; }),
              HasSubstr("/nowhere/hand.xml"));
}

TEST(HandSettings, AModelMustBeARegularFile) {
  const test::TemporaryDirectory folder;
  const std::filesystem::path pipe = folder.path() / "hand.xml";
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  EXPECT_EQ(Refusal([&](HandConfig& c) { c.model_path = pipe; }),
            "hand.model_path: " + pipe.string() + ": is a pipe, must be a regular file");
}

TEST(HandSettings, AMissingPartIsNamedWithItsNeighbour) {
  std::string xml = SmallHand{}.Xml();
  const std::string name = "name=\"joint_spool\"";
  xml.replace(xml.find(name), name.size(), "name=\"joint_spol\"");
  xml.replace(xml.find("joint=\"joint_spool\""), 19, "joint=\"joint_spol\"");
  try {
    MakeFromText(xml, {});
    FAIL() << "accepted a motor without its spool";
  } catch (const UserError& error) {
    EXPECT_THAT(error.what(), HasSubstr("the model has no joint 'joint_spool'"));
    EXPECT_THAT(error.what(), HasSubstr("joint_spol"));
  }
}

TEST(HandModel, DeclaresJointsMotorsAndCablesInTheOrderOfItsMotors) {
  const auto hand = MakeModel();
  EXPECT_EQ(hand->joint_names(), GloveChannelNames());
  EXPECT_EQ(hand->motor_names(), GloveChannelNames());
  EXPECT_EQ(hand->cable_names().size(), 36u);
  EXPECT_EQ(hand->cable_names()[1], "thumb_rotation_extensor");
}

TEST(HandSettings, AModelWithImpossibleCablesIsRefused) {
  const auto refusal = [](SmallHand small) {
    try {
      small.Make();
    } catch (const UserError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_THAT(refusal({.stiffness_n_m = -5}), HasSubstr("stiffness"));
  EXPECT_THAT(refusal({.stiffness_n_m = 0}),
              ContainsRegex("small_hand_.*xml: stiffness of tendon 'joint_flexor'"));
  EXPECT_THAT(refusal({.drum_radius_m = 0}), HasSubstr("joint_drum"));
  EXPECT_EQ(refusal({}), "");
}

TEST(HandSettings, FrictionOfNoMotorOrAnotherNumberOfThemIsRefused) {
  const auto of_motors = [](std::vector<double> scale) {
    return Refusal([&scale](HandConfig& c) { c.motor_friction_scale = scale; });
  };
  EXPECT_THAT(of_motors({1.0, 2.0}),
              HasSubstr("hand.motor_friction_scale: has 2 values, must have 1 for all motors or "
                        "18, one for each"));
  EXPECT_THAT(of_motors({}), HasSubstr("motor_friction_scale: has 0 values"));
  EXPECT_THAT(of_motors({-1.0}), HasSubstr("motor_friction_scale"));
}

}  // namespace
}  // namespace gauntlet::sim::testing
