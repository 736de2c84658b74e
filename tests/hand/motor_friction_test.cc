// Friction that differs from motor to motor.
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/hand/hand_fixture.h"

namespace gauntlet::sim::testing {
namespace {

HandConfig Hand18(std::vector<double> scale) {
  HandConfig config;
  config.motor_friction_scale = std::move(scale);
  return config;
}

/// Where joints stand on their way from one posture to another.
std::vector<double> Moved(const HandConfig& config) {
  const auto model = MakeModel(config);
  Hand hand(model);
  const std::vector<double> home = HomePosture(model->transmission());
  hand.Reset(home);
  std::vector<double> goal = home;
  for (double& angle : goal) angle += 0.15;
  hand.SetCommand(CountsFor(model->transmission(), goal));
  StepTimes(hand, 150);
  return JointAngles(hand);
}

TEST(MotorFriction, OfAllMotorsIsThatOfSpoolsGearsAndCablesScaled) {
  HandConfig scaled;
  for (ServoConfig* servo : {&scaled.servo, &scaled.arm_servo}) {
    servo->numbers().friction_scale *= 0.5;
    servo->numbers().load_friction *= 0.5;
  }
  scaled.cable.capstan_friction *= 0.5;
  EXPECT_EQ(Moved(Hand18({0.5})), Moved(scaled));
  EXPECT_EQ(Moved(Hand18(std::vector<double>(18, 0.5))), Moved(scaled));
  EXPECT_NE(Moved(Hand18({0.5})), Moved(Hand18({1.0})));
}

TEST(MotorFriction, OfOneMotorIsFeltAtItsJointAndNotByOtherFingers) {
  const std::vector<std::string> motors = MakeModel()->motor_names();
  const auto place = [&](const std::string& name) {
    return static_cast<std::size_t>(std::ranges::find(motors, name) - motors.begin());
  };
  std::vector<double> scale(motors.size(), 1.0);
  scale[place("index_pip")] = 4.0;
  const std::vector<double> usual = Moved({});
  const std::vector<double> rubbing = Moved(Hand18(scale));
  EXPECT_LT(rubbing[place("index_pip")], usual[place("index_pip")] - 0.01);
  // The palm that both hang on gives way a little.
  EXPECT_NEAR(rubbing[place("ring_pip")], usual[place("ring_pip")], 1e-3);
}

TEST(MotorFriction, BeyondWhatMotorsHaveKeepsThemExactlyWhereTheyAre) {
  const auto model = MakeModel(Hand18({100.0}));
  Hand hand(model);
  const std::vector<double> home = HomePosture(model->transmission());
  hand.Reset(home);
  std::vector<double> before(18), after(18);
  hand.ReadSpoolAngles(before);
  std::vector<double> goal = home;
  for (double& angle : goal) angle += 0.3;
  hand.SetCommand(CountsFor(model->transmission(), goal));
  StepTimes(hand, 500);
  EXPECT_TRUE(hand.health().ok) << hand.health().problem;
  hand.ReadSpoolAngles(after);
  for (std::size_t motor = 0; motor < 16; ++motor) {  // those of the arm are strong
    EXPECT_EQ(after[motor], before[motor]) << model->motor_names()[motor];
  }
}

}  // namespace
}  // namespace gauntlet::sim::testing
