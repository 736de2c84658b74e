// What motors tell of slack cables.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "controller/slack_detector.h"
#include "tests/hand/servo_response.h"
#include "tests/hand/slow_motion.h"

namespace gauntlet::sim::testing {
namespace {

// The spool stands still while servo and cables differ by no more than its friction, of which a
// part grows with the load.
TEST(ServoTorque, HoldsTheCablesAtRestButForFriction) {
  Hand hand(MakeModel());
  const controller::TendonTransmission& map = hand.hand_model().transmission();
  hand.Reset(map.reference_angle_rad);
  hand.SetCommand(CountsFor(map, HomePosture(map)));
  StepTimes(hand, 1500);
  const std::vector<Drive>& drives = hand.hand_model().drives();
  std::vector<double> torque_nm(drives.size()), tension_n(2 * drives.size());
  hand.ReadServoTorques(torque_nm);
  hand.ReadCableTensions(tension_n);
  for (std::size_t i = 0; i < drives.size(); ++i) {
    const double load_nm = drives[i].drum_radius_m * (tension_n[2 * i] - tension_n[2 * i + 1]);
    const Spool& spool = drives[i].spool;
    const double friction_nm = spool.dry_friction_nm + spool.load_friction * std::abs(load_nm);
    EXPECT_NEAR(torque_nm[i], load_nm, friction_nm + 1e-9) << drives[i].name;
  }
  EXPECT_GT(*std::ranges::max_element(torque_nm), 0.01);
}

/// Friction of each motor while all joints swing at 0.5 Hz for 12 s, torques read as their mean
/// over 10 ms.
std::vector<double> FrictionOf(const HandConfig& config) {
  Hand hand(MakeModel(config));
  const controller::TendonTransmission& map = hand.hand_model().transmission();
  const std::size_t motors = map.motor_names.size();
  controller::SlackDetector detector({.memory_deg = 100.0}, static_cast<int>(motors));
  std::vector<double> now_nm(motors), mean_nm(motors), angle_rad(motors);
  for (int tick = 0; tick < 12000; ++tick) {
    if (tick % 20 == 0) {
      std::vector<double> told = map.reference_angle_rad;
      const double swing = 0.3 * std::sin(std::numbers::pi * tick * 1e-3);
      for (std::size_t i = 0; i < told.size(); ++i) {
        told[i] += swing * (map.joint_max_rad[i] - map.joint_min_rad[i]);
      }
      hand.SetCommand(CountsFor(map, told));
    }
    hand.Step();
    hand.ReadServoTorques(now_nm);
    for (std::size_t i = 0; i < motors; ++i) mean_nm[i] += 0.1 * now_nm[i];
    if (tick % 10 != 9) continue;
    hand.ReadSpoolAngles(angle_rad);
    detector.Step(angle_rad, mean_nm);
    std::ranges::fill(mean_nm, 0.0);
  }
  return {detector.friction_nm().begin(), detector.friction_nm().end()};
}

TEST(SlackDetector, FindsHalfAMillimetreInEveryFinger) {
  HandConfig slack;
  slack.cable.slack_mm = {0.5};
  const std::vector<double> healthy_nm = FrictionOf({});
  const std::vector<double> slack_nm = FrictionOf(slack);
  const double alarm_share = controller::SlackDetectorConfig{}.alarm_share;
  for (const int motor : FingerMotors()) {
    EXPECT_LT(slack_nm[motor], alarm_share * healthy_nm[motor]) << GloveChannelNames()[motor];
  }
}

TEST(Slack, OfOneMotorIsThatOfItsCablesAlone) {
  HandConfig config;
  config.cable.slack_mm = std::vector<double>(18, 0.0);
  config.cable.slack_mm[5] = 0.5;
  const auto usual = MakeModel();
  const auto slack = MakeModel(config);
  for (std::size_t motor = 0; motor < usual->drives().size(); ++motor) {
    for (std::size_t i = 0; i < 2; ++i) {
      const double longer_m = slack->drives()[motor].cables[i].natural_length_m -
                              usual->drives()[motor].cables[i].natural_length_m;
      EXPECT_NEAR(longer_m, motor == 5 ? 0.5e-3 : 0.0, 1e-12) << usual->motor_names()[motor];
    }
  }
}

// What a wearer sees of friction: docs/evidence/hand.md has the other servos and coefficients.
TEST(Friction, OfCablesLeavesMostOfASlowMotion) {
  EXPECT_GT(MoveSlowly({}, 5.0, false).share, 0.5);
  HandConfig stiff;
  stiff.servo.settings = StiffDynamixelServo{};
  EXPECT_GT(MoveSlowly(stiff, 5.0, false).share, 0.6);
  EXPECT_LT(MoveSlowly(stiff, 30.0, false).loop_deg, 3.0);
}

TEST(Cables, OfFingersBendAsThoseOfOpenHands) {
  const auto hand = MakeModel();
  for (const int motor : FingerMotors()) {
    const Drive& drive = hand->drives()[motor];
    for (const Cable& cable : drive.cables) {
      EXPECT_LT(cable.branches[0].bend_rad * kDegPerRad, 260.0) << cable.name;
      const double loss = cable.cord.friction_coefficient * cable.branches[0].bend_rad;
      EXPECT_GT(loss, 0.09) << cable.name;
      EXPECT_LT(loss, 0.9) << cable.name;
    }
  }
}

}  // namespace
}  // namespace gauntlet::sim::testing
