// Hands without cables: motors that turn joints, alone or several together, and linkages.
#include <fmt/core.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "sim/base/data_folder.h"
#include "sim/base/error.h"
#include "sim/base/random.h"
#include "sim/hand/drive.h"
#include "tests/hand/small_hand.h"

namespace gauntlet::sim::testing {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr double kRotor_kg_m2 = 2e-3;
constexpr double kLink_kg_m2 = 4e-4;

/// One or two hinges beside each other, without gravity; `actuator`: what turns them.
std::string Hinges(const std::string& actuator, const std::string& more = "") {
  const auto body = [](const char* name, double y, const char* spring) {
    return fmt::format(
        "<body name='{0}_link' pos='0 {1} 0'><inertial pos='0 0 0' mass='0.1' diaginertia='{2} {2} "
        "{2}'/><joint name='{0}' axis='0 1 0' range='-60 60' armature='{3}' {4}/></body>",
        name, y, kLink_kg_m2, kRotor_kg_m2, spring);
  };
  return fmt::format(
      "<mujoco><option gravity='0 0 0'/><worldbody>{}{}</worldbody><tendon><fixed name='sum'>"
      "<joint joint='near' coef='1'/><joint joint='far' coef='2'/></fixed></tendon>{}"
      "<actuator>{}</actuator></mujoco>",
      body("near", 0.0, "stiffness='0.02' damping='0.02'"),
      body("far", 0.1, "stiffness='0.02' damping='0.02'"), more, actuator);
}

constexpr const char* kDirect = "<motor name='m' joint='near' ctrlrange='-1 1'/>";
constexpr const char* kSum = "<position name='m' tendon='sum' forcerange='-1 1'/>";

/// A servo that is a spring and a damper, without steps, friction or play.
HandConfig Spring() {
  HandConfig config = FrictionFree();
  ServoNumbers& servo = config.servo.numbers();
  servo.frame_ms = 0.0;
  servo.full_torque_error_deg = 20.0;
  servo.damping_ms = 10.0;
  servo.no_load_speed_deg_s = 10000.0;
  servo.play_deg = 0.0;
  servo.travel_deg = 720.0;
  config.motor.windup_deg = 1.0;
  return config;
}

std::vector<double> AnglesOfAll(const Hand& hand) {
  std::vector<double> angle(hand.hand_model().joint_names().size());
  hand.ReadJointAngles(angle);
  return angle;
}

std::int32_t CountsAtShaft(const HandModel& model, double shaft_rad) {
  const controller::TendonTransmission& map = model.transmission();
  return static_cast<std::int32_t>(
      std::lround(map.center_counts[0] + map.counts_per_rad[0] * shaft_rad));
}

std::string ProblemOf(const std::string& xml, const HandConfig& config = {}) {
  try {
    MakeFromText(xml, config);
  } catch (const UserError& error) {
    return error.what();
  }
  return "";
}

// (rotor + link) q'' = gain (target - q) - servo damping q' - joint damping q' - spring q: the step
// response of a second-order system.
TEST(DirectDrive, RotorAndLinkAnswerAStepTogether) {
  const HandConfig config = Spring();
  const auto model = MakeFromText(Hinges(kDirect), config);
  ASSERT_EQ(TransmissionOf(model->drives()[0]), Transmission::kDirect);
  EXPECT_THAT(model->joint_names(), ElementsAre("near"));
  EXPECT_TRUE(model->cable_names().empty());
  Hand hand(model);
  const double target = 0.2;
  const std::int32_t counts = CountsAtShaft(*model, target);
  const Servo& servo = model->drives()[0].servo;
  const double inertia = kRotor_kg_m2 + kLink_kg_m2;
  const double stiffness = servo.gain_nm_rad + 0.02;
  const double damping = servo.damping_nm_s_rad + 0.02;
  const double end = servo.gain_nm_rad * target / stiffness;
  const double decay = 0.5 * damping / inertia;
  const double turn = std::sqrt(stiffness / inertia - decay * decay);
  ASSERT_GT(turn, 0.0);
  double worst = 0.0;
  hand.SetCommand({&counts, 1});
  for (int tick = 1; tick <= 300; ++tick) {
    hand.Step();
    const double t = 1e-3 * tick;
    const double expected =
        end *
        (1.0 - std::exp(-decay * t) * (std::cos(turn * t) + decay / turn * std::sin(turn * t)));
    worst = std::max(worst, std::abs(AnglesOfAll(hand)[0] - expected));
  }
  // A step of 1 ms, and the twist of the gear: 1 deg at the stall torque.
  EXPECT_LT(worst, 0.03 * target);
  StepTimes(hand, 700);
  EXPECT_NEAR(AnglesOfAll(hand)[0], end, 2e-3 * target);
}

// Both springs feel the shaft's torque times their ratios; the shaft turns by the sum.
TEST(DirectDrive, SpringsShareTheWayOfAMotorOfSeveralJoints) {
  const auto model = MakeFromText(Hinges(kSum), Spring());
  EXPECT_EQ(TransmissionOf(model->drives()[0]), Transmission::kLinkage);
  EXPECT_THAT(model->joint_names(), ElementsAre("near", "far"));
  EXPECT_THAT(model->transmission().coupling, ElementsAre(1.0, 2.0));
  // armature / ratio^2 of both joints, in the mean.
  EXPECT_NEAR(model->drives()[0].spool.inertia_kg_m2, 0.5 * (1.0 + 0.25) * kRotor_kg_m2, 1e-12);
  Hand hand(model);
  const std::int32_t counts = CountsAtShaft(*model, 0.5);
  Hold(hand, counts, 5000);
  const std::vector<double> angle = AnglesOfAll(hand);
  double spool = 0.0;
  hand.ReadSpoolAngles({&spool, 1});
  EXPECT_NEAR(angle[1], 2.0 * angle[0], 1e-4);
  EXPECT_NEAR(angle[0] + 2.0 * angle[1], spool, 1e-3);
  EXPECT_GT(spool, 0.4);
}

// Within the play the shaft does not touch the joint.
TEST(DirectDrive, BacklashLetsTheMotorTurnAlone) {
  HandConfig config = Spring();
  config.cable.backlash_deg = 6.0;
  const auto model = MakeFromText(Hinges(kDirect), config);
  Hand hand(model);
  const double half_play = 3.0 * kRadPerDeg;
  Hold(hand, CountsAtShaft(*model, 0.4 * half_play), 1000);  // also when it overshoots
  EXPECT_EQ(AnglesOfAll(hand)[0], 0.0);
  Hold(hand, CountsAtShaft(*model, 0.3), 1000);
  double spool = 0.0;
  hand.ReadSpoolAngles({&spool, 1});
  EXPECT_NEAR(AnglesOfAll(hand)[0], spool - half_play, 2e-3);
}

TEST(DirectDrive, JointCentresOfABuiltHandAreOff) {
  HandConfig config = Spring();
  config.assembly_error.centre_deg = 3.0;
  const auto model = MakeFromText(Hinges(kDirect), config);
  const double off = model->center_error_rad()[0];
  ASSERT_GT(std::abs(off), 1e-3);
  Hand hand(model);
  hand.Reset({&off, 1});
  double spool = 1.0;
  hand.ReadSpoolAngles({&spool, 1});
  EXPECT_NEAR(spool, 0.0, 1e-12);
  StepTimes(hand, 500);
  // The springs pull it back a little.
  EXPECT_NEAR(AnglesOfAll(hand)[0], off, 0.02 * std::abs(off));
}

TEST(DirectDrive, SettingsReplaceTheNumbersOfTheModel) {
  HandConfig config = Spring();
  config.servo.numbers().friction_scale = 1.0;
  config.motor.stall_torque_nm = {0.7};
  config.motor.rotor_inertia_kg_m2 = {0.004};
  config.motor.dry_friction_nm = {0.02};
  const auto model = MakeFromText(Hinges(kDirect), config);
  const Drive& drive = model->drives()[0];
  EXPECT_EQ(drive.servo.stall_torque_nm, 0.7);
  EXPECT_EQ(drive.spool.inertia_kg_m2, 0.004);
  EXPECT_EQ(drive.spool.dry_friction_nm, 0.02);
  config.motor.stall_torque_nm = {0.7, 0.8};
  EXPECT_THAT(ProblemOf(Hinges(kDirect), config),
              HasSubstr("hand.motor.stall_torque_nm: has 2 values"));
}

TEST(DirectDrive, SlackOfCablesIsRefused) {
  HandConfig config = Spring();
  config.cable.slack_mm = {2.0};
  EXPECT_THAT(ProblemOf(Hinges(kDirect), config),
              HasSubstr("hand.cable.slack_mm: must be 0: the hand has no cables"));
}

TEST(DirectDrive, WhatTheModelDoesNotSayIsAskedFor) {
  EXPECT_THAT(ProblemOf(Hinges("<position name='m' joint='near'/>")),
              HasSubstr("hand.motor.stall_torque_nm: is needed: the model has no stall torque of "
                        "motor 'm'"));
  std::string light = Hinges(kDirect);
  for (std::size_t at; (at = light.find("armature")) != std::string::npos;) {
    light.erase(at, light.find('\'', at + 10) + 1 - at);
  }
  EXPECT_THAT(ProblemOf(light), HasSubstr("hand.motor.rotor_inertia_kg_m2: is needed"));
  EXPECT_THAT(ProblemOf(Hinges("")), HasSubstr("the model has no motor"));
  EXPECT_THAT(ProblemOf("<mujoco/>"), HasSubstr("the model has no motor"));
  EXPECT_THAT(ProblemOf(Hinges("<motor joint='near' ctrlrange='-1 1'/>")),
              HasSubstr("motor 1 of the model has no name"));
}

std::string Equality(const std::string& follower, const std::string& leader, double ratio) {
  return fmt::format("<joint joint1='{}' joint2='{}' polycoef='0.1 {} 0 0 0'/>", follower, leader,
                     ratio);
}

TEST(Linkages, LoopsAreRefusedWithTheirJoints) {
  const auto with = [](const std::string& equalities) {
    return Hinges(kDirect, "<equality>" + equalities + "</equality>");
  };
  EXPECT_THAT(ProblemOf(with(Equality("near", "far", 1) + Equality("far", "near", 1))),
              HasSubstr("drives itself by a loop of linkages: near, far, near"));
  EXPECT_THAT(ProblemOf(with(Equality("near", "far", 1) + Equality("near", "far", 2))),
              HasSubstr("joint 'near' of the model follows two others"));
}

// far = 0.1 + 0.5 near is turned by 0.5 where the motor turns by 1, and the other way round.
TEST(Linkages, AMotorOfAFollowerTurnsItsLeader) {
  const std::string linkage = "<equality>" + Equality("far", "near", 0.5) + "</equality>";
  const auto model =
      MakeFromText(Hinges("<motor name='m' joint='far' ctrlrange='-1 1'/>", linkage), Spring());
  EXPECT_THAT(model->joint_names(), ElementsAre("near"));
  EXPECT_NEAR(model->transmission().coupling[0], 0.5, 1e-12);
}

TEST(Linkages, AChainOfThemIsOne) {
  const std::string chain =
      "<mujoco><worldbody><body><joint name='a'/><geom size='1'/><body><joint name='b'/><geom "
      "size='1'/><body><joint name='c'/><geom size='1'/></body></body></body></worldbody>"
      "<equality>" +
      Equality("c", "b", 2) + Equality("b", "a", 3) + "</equality></mujoco>";
  char message[300] = "";
  const std::string file =
      (std::filesystem::temp_directory_path() / fmt::format("chain_{}.xml", getpid())).string();
  std::ofstream(file) << chain;
  mjModel* const model = mj_loadXML(file.c_str(), nullptr, message, sizeof message);
  std::filesystem::remove(file);
  ASSERT_NE(model, nullptr) << message;
  const std::vector<Follower> followers = FindFollowers(*model);
  ASSERT_EQ(followers.size(), 2u);
  // c = 0.1 + 2 b = 0.1 + 2 (0.1 + 3 a)
  EXPECT_EQ(followers[0].leader_qpos, 0);
  EXPECT_NEAR(followers[0].Angle(0.2), 0.3 + 6.0 * 0.2, 1e-12);
  EXPECT_NEAR(followers[1].Angle(0.2), 0.1 + 3.0 * 0.2, 1e-12);
  mj_deleteModel(model);
}

// A tendon that a motor pulls, without a spool in the model: it needs a drum and a stiffness.
TEST(PulledTendons, ArePulledWithAGivenDrum) {
  const std::string xml =
      "<mujoco><option gravity='0 0 0'/><worldbody><site name='a' pos='-0.05 0 -0.01'/><body "
      "name='link'><joint name='near' axis='0 1 0' range='0 90' stiffness='0.1' springref='-20'/>"
      "<geom size='0.01' pos='0.03 0 0' mass='0.05'/><site name='b' pos='0.02 0 -0.01'/></body>"
      "</worldbody><tendon><spatial name='cord'><site site='a'/><site site='b'/></spatial></tendon>"
      "<actuator><position name='m' tendon='cord' forcerange='-50 0'/></actuator></mujoco>";
  HandConfig config = Spring();
  config.motor.rotor_inertia_kg_m2 = {3e-4};
  EXPECT_THAT(ProblemOf(xml, config), HasSubstr("hand.motor.drum_radius_mm: is needed"));
  config.motor.drum_radius_mm = {8.0};
  EXPECT_THAT(ProblemOf(xml, config), HasSubstr("hand.cable.stiffness_n_m: is needed"));
  config.cable.stiffness_n_m = 2e4;
  config.cable.pretension_mm = 0.05;
  const auto model = MakeFromText(xml, config);
  EXPECT_THAT(model->cable_names(), ElementsAre("cord"));
  EXPECT_NEAR(model->drives()[0].servo.stall_torque_nm, 50.0 * 8e-3, 1e-12);
  Hand hand(model);
  const double before = AnglesOfAll(hand)[0];
  Hold(hand, CountsAtShaft(*model, 0.4), 1000);
  EXPECT_GT(AnglesOfAll(hand)[0], before + 0.1);
  double tension = 0.0;
  hand.ReadCableTensions({&tension, 1});
  EXPECT_GT(tension, 1.0);
}

// models/three_finger_hand.xml: every joint goes where its command says, but for gravity's part.
TEST(ThreeFingerHand, FollowsPosturesWithoutCables) {
  HandConfig config = FrictionFree();
  config.model_path = (DataFolder("models") / "three_finger_hand.xml").string();
  const auto model = MakeModel(config);
  const controller::TendonTransmission& map = model->transmission();
  ASSERT_EQ(map.motor_names.size(), 8u);
  EXPECT_TRUE(model->cable_names().empty());
  for (const Drive& drive : model->drives()) {
    EXPECT_EQ(TransmissionOf(drive), Transmission::kDirect) << drive.name;
  }
  Hand hand(model);
  RandomStream random(1, "postures", 0);
  for (int posture = 0; posture < 5; ++posture) {
    const std::vector<double> angle = RandomPosture(map, random);
    hand.SetCommand(CountsFor(map, angle));
    StepTimes(hand, 1500);
    ASSERT_TRUE(hand.health().ok) << hand.health().problem;
    const std::vector<double> reached = AnglesOfAll(hand);
    for (std::size_t joint = 0; joint < angle.size(); ++joint) {
      EXPECT_NEAR(reached[joint], angle[joint], 0.5 * kRadPerDeg) << map.joint_names[joint];
    }
  }
}

}  // namespace
}  // namespace gauntlet::sim::testing
