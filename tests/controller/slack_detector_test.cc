#include "controller/slack_detector.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "tests/controller/allocation_counter.h"

namespace gauntlet::controller {
namespace {

/// A motor that swings by 45 deg at 0.5 Hz, read 100 times per second: dry friction, a constant
/// load, a rotor, and for the first 2 deg after a reversal no friction yet.
class Swinging {
 public:
  double friction_nm = 0.05;
  double load_nm = 0.0;
  double inertia_kg_m2 = 2e-3;

  void Watch(SlackDetector& detector, double seconds) {
    for (int reading = 0; reading < 100 * seconds; ++reading, ++reading_) {
      const double phase = std::numbers::pi * reading_ / 100.0;
      const double angle = kSwing_rad * std::sin(phase);
      const double speed = kSwing_rad * std::numbers::pi * std::cos(phase);
      const double acceleration = -std::numbers::pi * std::numbers::pi * angle;
      const double behind = kSwing_rad - std::abs(angle);
      const bool taken_up = behind > 0.035 || speed * angle > 0.0;
      const double torque = (taken_up ? std::copysign(friction_nm, speed) : 0.0) + load_nm +
                            inertia_kg_m2 * acceleration;
      detector.Step({&angle, 1}, {&torque, 1});
    }
  }

 private:
  static constexpr double kSwing_rad = std::numbers::pi / 4.0;
  int reading_ = 0;
};

TEST(SlackDetector, FrictionIsHalfOfWhatMotorsNeedMoreForwardThanBack) {
  SlackDetector detector({}, 1);
  Swinging motor;
  motor.load_nm = 0.2;
  motor.Watch(detector, 5.0);
  EXPECT_TRUE(std::isnan(detector.friction_nm()[0])) << "too early";
  motor.Watch(detector, 60.0);
  EXPECT_NEAR(detector.friction_nm()[0], 0.05, 0.001);
}

TEST(SlackDetector, AlarmsWhenFrictionFallsAndTakesItBackWhenItReturns) {
  SlackDetector detector({.healthy_friction_nm = {0.05}}, 1);
  Swinging motor;
  motor.Watch(detector, 60.0);
  EXPECT_EQ(detector.slack()[0], 0);
  motor.friction_nm = 0.02;
  motor.Watch(detector, 60.0);
  EXPECT_EQ(detector.slack()[0], 1);
  motor.friction_nm = 0.05;
  motor.load_nm = 0.3;  // as when something is held
  motor.Watch(detector, 60.0);
  EXPECT_EQ(detector.slack()[0], 0);
  motor.friction_nm = 0.02;
  motor.Watch(detector, 60.0);
  detector.Reset();
  EXPECT_EQ(detector.slack()[0], 0);
  EXPECT_TRUE(std::isnan(detector.friction_nm()[0]));
}

// A motor that stands and trembles by less than it must turn back has not moved.
TEST(SlackDetector, SeesNothingInAMotorThatTrembles) {
  SlackDetector detector({.healthy_friction_nm = {0.05}, .memory_deg = 5.0}, 1);
  for (int k = 0; k < 100000; ++k) {
    const double angle = 0.3 + 0.002 * ((k % 3) - 1);
    const double torque = 0.0;
    detector.Step({&angle, 1}, {&torque, 1});
  }
  EXPECT_TRUE(std::isnan(detector.friction_nm()[0]));
}

TEST(SlackDetector, LeavesReadingsOutThatAreNoNumberAndDoesNotAllocate) {
  SlackDetector detector({}, 1);
  Swinging motor;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double one = 1.0;
  const long before = AllocationCount();
  for (int k = 0; k < 65; ++k) {
    motor.Watch(detector, 1.0);
    detector.Step({&nan, 1}, {&one, 1});
    detector.Step({&one, 1}, {&nan, 1});
  }
  EXPECT_EQ(AllocationCount(), before);
  EXPECT_NEAR(detector.friction_nm()[0], 0.05, 0.001);
}

TEST(SlackDetector, RefusesWhatDoesNotFit) {
  EXPECT_THROW(SlackDetector({.healthy_friction_nm = {0.1, 0.2}}, 3), SettingError);
  EXPECT_THROW(SlackDetector({.alarm_share = 1.1}, 3), SettingError);
  EXPECT_THROW(SlackDetector({.memory_deg = 0.0}, 3), SettingError);
}

}  // namespace
}  // namespace gauntlet::controller
