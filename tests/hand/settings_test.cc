#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>
#include <functional>

#include "sim/base/error.h"
#include "tests/hand/hand_fixture.h"
#include "tests/hand/small_hand.h"

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
  EXPECT_THAT(Refusal([](HandConfig& c) { c.servo.no_load_speed_deg_s = 0; }),
              HasSubstr("servo.no_load_speed_deg_s"));
  EXPECT_THAT(Refusal([](HandConfig& c) { c.servo.resolution_bits = 3; }),
              HasSubstr("servo.resolution_bits"));
}

TEST(HandSettings, ATravelThatTheSpoolCannotWindIsRefused) {
  const std::string message = Refusal([](HandConfig& c) { c.servo.travel_deg = 200; });
  EXPECT_THAT(message, HasSubstr("hand.servo.travel_deg"));
  EXPECT_THAT(message, HasSubstr("must wind"));
}

TEST(HandSettings, AStepThatDoesNotDivideTheSampleIsRefused) {
  EXPECT_THAT(Refusal([](HandConfig& c) { c.step_ms = 0.3; }), HasSubstr("hand.step_ms"));
}

TEST(HandSettings, WhatTheTimeStepCannotBearIsRefused) {
  EXPECT_THAT(Refusal([](HandConfig& c) { c.servo.damping_ms = 100; }), HasSubstr("hand.servo"));
  const auto far_too_stiff = [](HandConfig& c) {
    c.cable.stretch = false;
    c.cable.stiffness_scale = 9.9;
  };
  EXPECT_THAT(Refusal(far_too_stiff), HasSubstr("too stiff for hand.step_ms 1"));
  EXPECT_EQ(Refusal([&](HandConfig& c) { c.cable.stretch = false; }), "");
}

TEST(HandSettings, AMissingModelIsNamed) {
  EXPECT_THAT(Refusal([](HandConfig& c) { c.model_path = "/nowhere/hand.xml"; }),
              HasSubstr("/nowhere/hand.xml"));
}

TEST(HandSettings, AnUnknownJointIsNamedWithItsNeighbour) {
  try {
    HandModel({}, {"index_mpc"});
    FAIL() << "accepted an unknown joint";
  } catch (const UserError& error) {
    EXPECT_THAT(error.what(), HasSubstr("hand_arm.xml: the model has no joint 'index_mpc'"));
    EXPECT_THAT(error.what(), HasSubstr("index_mcp"));
  }
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

}  // namespace
}  // namespace gauntlet::sim::testing
