#include "sim/hand/servo.h"

#include <gmock/gmock.h>

#include <algorithm>

#include "tests/hand/hand_fixture.h"
#include "tests/hand/small_hand.h"

namespace gauntlet::sim::testing {
namespace {

constexpr Servo kServo{.gain_nm_rad = 10.0,
                       .damping_nm_s_rad = 0.1,
                       .dead_band_rad = 0.01,
                       .stall_torque_nm = 0.5,
                       .no_load_speed_rad_s = 7.0};

TEST(Servo, TorqueIsProportionalBeyondTheDeadBandAndLimited) {
  EXPECT_EQ(ComputeServoTorque(kServo, 0.009, 0.0, 0.0).torque_nm, 0.0);
  EXPECT_NEAR(ComputeServoTorque(kServo, 0.03, 0.0, 0.0).torque_nm, 0.2, 1e-12);
  EXPECT_NEAR(ComputeServoTorque(kServo, -0.03, 0.0, 0.0).torque_nm, -0.2, 1e-12);
  const ServoTorque most = ComputeServoTorque(kServo, 1.0, 0.0, 0.0);
  EXPECT_EQ(most.torque_nm, 0.5);
  EXPECT_TRUE(most.saturated);
  EXPECT_FALSE(ComputeServoTorque(kServo, 0.03, 0.0, 0.0).saturated);
}

// The line from stall torque to no-load speed; beyond that speed the motor brakes.
TEST(Servo, BackEmfTakesTorqueAway) {
  EXPECT_NEAR(ComputeServoTorque(kServo, 9.0, 0.0, 3.5).torque_nm, 0.25, 1e-12);
  EXPECT_NEAR(ComputeServoTorque(kServo, 9.0, 0.0, 7.0).torque_nm, 0.0, 1e-12);
  EXPECT_LT(ComputeServoTorque(kServo, 9.0, 0.0, 8.0).torque_nm, 0.0);
  EXPECT_EQ(ComputeServoTorque(kServo, -9.0, 0.0, 3.5).torque_nm, -0.5);
}

// A third of the motor's current is a third of the torque until the voltage allows less.
TEST(Servo, ALimitOfTheMotorsCurrentLimitsTorqueInProportion) {
  Servo servo = kServo;
  servo.current_share = 0.3;
  EXPECT_NEAR(ComputeServoTorque(servo, 9.0, 0.0, 0.0).torque_nm, 0.15, 1e-12);
  EXPECT_NEAR(ComputeServoTorque(servo, 9.0, 0.0, 3.5).torque_nm, 0.15, 1e-12);
  EXPECT_NEAR(ComputeServoTorque(servo, 9.0, 0.0, 6.3).torque_nm, 0.05, 1e-12);
  EXPECT_NEAR(ComputeServoTorque(servo, -9.0, 0.0, 3.5).torque_nm, -0.15, 1e-12);
  EXPECT_TRUE(ComputeServoTorque(servo, 0.03, 0.0, 0.0).saturated);
}

// The supply gives duty cycle times the motor's current: u (u - x) = i, and the torque is u - x.
TEST(Servo, ALimitOfTheSupplysCurrentLeavesTheSquareRootAtStall) {
  Servo servo = kServo;
  servo.current_share = 0.25;
  servo.limits_supply = true;
  EXPECT_NEAR(ComputeServoTorque(servo, 9.0, 0.0, 0.0).torque_nm, 0.25, 1e-12);
  for (const double x : {0.1, 0.5, 0.7}) {
    const double share = ComputeServoTorque(servo, 9.0, 0.0, 7.0 * x).torque_nm / 0.5;
    EXPECT_NEAR((share + x) * share, 0.25, 1e-12) << x;
  }
  EXPECT_NEAR(ComputeServoTorque(servo, 9.0, 0.0, 6.3).torque_nm, 0.05, 1e-12);
  EXPECT_NEAR(ComputeServoTorque(servo, -9.0, 0.0, 0.0).torque_nm, -0.25, 1e-12);
}

SmallHand Weightless() {
  SmallHand small;
  small.gravity_m_s2 = 0.0;
  small.config.cable.capstan_friction = 0.0;
  return small;
}

TEST(ServoInTheHand, SpoolsNeverTurnFasterThanTheirNoLoadSpeed) {
  for (double limit_deg_s : {100.0, 250.0}) {
    SmallHand small = Weightless();
    small.config.servo.numbers().no_load_speed_deg_s = limit_deg_s;
    const auto model = small.Make();
    Hand hand(model);
    hand.Reset(std::vector<double>{-0.9});
    const std::int32_t counts = JointCommand(*model, 0.9);
    hand.SetCommand({&counts, 1});
    double fastest = 0.0;
    for (int i = 0; i < 300; ++i) {
      hand.Step();
      double speed = 0.0;
      hand.ReadSpoolSpeeds({&speed, 1});
      fastest = std::max(fastest, speed * kDegPerRad);
    }
    EXPECT_LT(fastest, 1.06 * limit_deg_s) << "cables may pull it a little beyond";
    EXPECT_GT(fastest, 0.9 * limit_deg_s);
  }
}

TEST(ServoInTheHand, CommandsWaitForTheNextFrame) {
  SmallHand small = Weightless();
  small.config.servo.numbers().frame_ms = 20.0;
  const auto model = small.Make();
  Hand hand(model);
  const std::int32_t rest = JointCommand(*model, 0.0);
  const std::int32_t bent = JointCommand(*model, 0.5);
  Hold(hand, rest, 5);  // the clock of frames starts here
  Hold(hand, bent, 15);
  EXPECT_NEAR(Read(hand).spool_rad, 0.0, 3e-3) << "moved before the frame at 20 ms";
  Hold(hand, bent, 10);
  EXPECT_GT(Read(hand).spool_rad, 0.02);
}

TEST(ServoInTheHand, ErrorsWithinTheDeadBandAreLeft) {
  SmallHand small = Weightless();
  small.config.servo.numbers().resolution_bits = 16;
  small.config.servo.numbers().dead_band_deg = 1.0;
  const auto model = small.Make();
  Hand hand(model);
  Hold(hand, JointCommand(*model, 0.9 * kRadPerDeg), 500);
  EXPECT_NEAR(Read(hand).spool_rad * kDegPerRad, 0.0, 1e-2);
  Hold(hand, JointCommand(*model, 2.0 * kRadPerDeg), 500);
  const double stopped_deg = Read(hand).spool_rad * kDegPerRad;
  EXPECT_GT(stopped_deg, 0.95);
  EXPECT_LT(stopped_deg, 1.2);
}

// One count is travel / (2^bits - 1): the servo's precision is a setting.
TEST(ServoInTheHand, ResolutionIsTheTravelOverTheCounts) {
  for (int bits : {8, 10, 12}) {
    SmallHand small = Weightless();
    small.config.servo.numbers().resolution_bits = bits;
    small.config.servo.numbers().dead_band_deg = 0.0;
    const auto model = small.Make();
    Hand hand(model);
    const std::int32_t center = model->transmission().center_counts[0];
    Hold(hand, center + 1, 800);
    EXPECT_NEAR(Read(hand).spool_rad * kDegPerRad, 300.0 / ((1 << bits) - 1), 2e-3) << bits;
  }
}

}  // namespace
}  // namespace gauntlet::sim::testing
