#include "controller/joint_loop.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "controller/controller.h"
#include "controller/number.h"
#include "tests/controller/allocation_counter.h"
#include "tests/controller/test_hand.h"

namespace gauntlet::controller {
namespace {

constexpr double kDeg = std::numbers::pi / 180.0;
constexpr double kEvents_hz = 50.0;

/// Fine enough motors that only dead_band_deg counts.
TendonTransmission SensingHand(int joints) {
  TendonTransmission hand = CoupledHand(joints);
  hand.counts_per_rad.assign(hand.counts_per_rad.size(), 1e5);
  hand.min_counts.assign(hand.min_counts.size(), -1'000'000);
  hand.max_counts.assign(hand.max_counts.size(), 1'000'000);
  hand.joint_sensors = true;
  return hand;
}

/// A loop of one joint.
class OneJoint {
 public:
  explicit OneJoint(const JointLoopConfig& config) : loop_(config, SensingHand(1), kEvents_hz) {
    Reset(0.0);
  }
  void Reset(double target_deg) {
    const double target = target_deg * kDeg;
    loop_.Reset({&target, 1});
  }
  void SetMeasuredAngles(double measured_deg) {
    const double measured = measured_deg * kDeg;
    loop_.SetMeasuredAngles({&measured, 1});
  }
  double Step(double target_deg) {
    const double target = target_deg * kDeg;
    double corrected = 0.0;
    loop_.Step({&target, 1}, {&corrected, 1});
    return corrected / kDeg;
  }
  JointLoop& loop() { return loop_; }

 private:
  JointLoop loop_;
};

JointLoopConfig PlainPi() {
  return {.kind = JointLoopKind::kPi,
          .proportional = 0.0,
          .integral_per_s = 0.0,
          .expected_delay_ms = 0.0,
          .dead_band_deg = 0.0,
          .friction_turn_deg = 0.0};
}

// By hand, with the half count of 0.29e-3 deg that is always left: 1e-3 deg of tolerance.
TEST(JointLoop, AddsTheErrorsShareAndItsIntegral) {
  JointLoopConfig config = PlainPi();
  config.proportional = 0.5;
  config.integral_per_s = 2.0;
  OneJoint joint(config);
  for (int event = 1; event <= 5; ++event) {
    joint.SetMeasuredAngles(38.0);
    EXPECT_NEAR(joint.Step(40.0), 40.0 + 1.0 + event * 2.0 * 2.0 / kEvents_hz, 2e-3);
  }
}

TEST(JointLoop, HoldsMeasuredAnglesAgainstWhatWasWantedThen) {
  JointLoopConfig config = PlainPi();
  config.proportional = 1.0;
  config.expected_delay_ms = 50.0;  // 2.5 events
  OneJoint joint(config);
  // A hand that is late by just that, on a ramp of 1 deg per event: nothing to correct.
  for (int event = 1; event <= 60; ++event) {
    joint.SetMeasuredAngles(std::max(0.0, event - 2.5));
    if (event > 4) {
      EXPECT_NEAR(joint.Step(event), event, 1e-3);
    } else {
      joint.Step(event);
    }
  }
}

TEST(JointLoop, LeavesErrorsWithinItsDeadBandAndWithinHalfAMotorCount) {
  JointLoopConfig config = PlainPi();
  config.proportional = 1.0;
  config.dead_band_deg = 0.5;
  OneJoint joint(config);
  joint.SetMeasuredAngles(39.51);
  EXPECT_EQ(joint.Step(40.0), 40.0);
  joint.SetMeasuredAngles(39.0);
  EXPECT_NEAR(joint.Step(40.0), 40.5, 1e-3);

  config.dead_band_deg = 0.0;
  TendonTransmission coarse = CoupledHand(1);
  coarse.joint_sensors = true;  // 100 counts per rad: half of one is 5 mrad
  JointLoop loop(config, coarse, kEvents_hz);
  const double target = 0.7;
  double measured = target - 4.9e-3;
  double corrected = 0.0;
  loop.SetMeasuredAngles({&measured, 1});
  loop.Step({&target, 1}, {&corrected, 1});
  EXPECT_EQ(corrected, target);
  measured = target - 15e-3;
  loop.SetMeasuredAngles({&measured, 1});
  loop.Step({&target, 1}, {&corrected, 1});
  EXPECT_NEAR(corrected, target + 10e-3, 1e-12);
}

// Friction is the inverse of play: behind a play of 2 deg the joint goes where it is told, both
// ways, and a target that trembles by less than friction_turn_deg moves nothing.
TEST(JointLoop, UndoesPlay) {
  JointLoopConfig config = PlainPi();
  config.friction_deg = {1.0};
  config.friction_turn_deg = 0.4;
  OneJoint joint(config);
  double behind_play = 0.0;
  const auto told = [&](double target_deg) {
    const double pulled = joint.Step(target_deg);
    behind_play = std::clamp(behind_play, pulled - 1.0, pulled + 1.0);
    return behind_play;
  };
  told(1.0);
  for (double deg = 1.0; deg < 40.0; deg += 0.5) EXPECT_NEAR(told(deg), deg, 1e-9);
  told(39.0);
  for (double deg = 38.5; deg > 5.0; deg -= 0.5) EXPECT_NEAR(told(deg), deg, 1e-9);
  const double still = told(5.0);
  for (int k = 0; k < 50; ++k) EXPECT_NEAR(told(5.0 + (k % 2) * 0.39), still, 0.4);
  EXPECT_NEAR(joint.Step(5.0), 4.0, 1e-9);  // still the way down
}

TEST(JointLoop, IntegralStandsStillAtTheLimitAndComesBackAtOnce) {
  JointLoopConfig config = PlainPi();
  config.integral_per_s = 10.0;
  config.max_correction_deg = 3.0;
  OneJoint joint(config);
  for (int event = 0; event < 500; ++event) {
    joint.SetMeasuredAngles(30.0);
    EXPECT_LE(joint.Step(40.0), 43.0 + 1e-9);
  }
  // 10 deg of error at 10 / s and 50 Hz: 2 deg per event.
  joint.SetMeasuredAngles(50.0);
  EXPECT_NEAR(joint.Step(40.0), 42.0, 2.1);
  joint.SetMeasuredAngles(50.0);
  EXPECT_NEAR(joint.Step(40.0), 40.0, 2.1);
}

// A wearer who bends farther than the hand can: nothing to correct, and nothing winds up.
TEST(JointLoop, StaysWithinTheJointsRangeAndDoesNotWindUpThere) {
  JointLoopConfig config = PlainPi();
  config.integral_per_s = 10.0;
  OneJoint joint(config);
  const double most_deg = 1.5 / kDeg;
  for (int event = 0; event < 500; ++event) {
    joint.SetMeasuredAngles(most_deg - 2.0);
    EXPECT_NEAR(joint.Step(most_deg + 20.0), most_deg, 1e-9);
  }
  joint.SetMeasuredAngles(50.0);
  EXPECT_NEAR(joint.Step(50.0), 50.0, 0.5);
}

TEST(JointLoop, UsesNoReadingThatIsOldOrNoNumberAndKeepsItsIntegral) {
  JointLoopConfig config = PlainPi();
  config.proportional = 1.0;
  config.integral_per_s = 10.0;
  config.stale_after_ms = 40.0;  // two events
  OneJoint joint(config);
  EXPECT_EQ(joint.Step(40.0), 40.0);  // nothing measured yet
  joint.SetMeasuredAngles(39.0);
  EXPECT_NEAR(joint.Step(40.0), 41.2, 2e-3);
  EXPECT_NEAR(joint.Step(40.0), 41.4, 2e-3);
  EXPECT_NEAR(joint.Step(40.0), 41.6, 2e-3);
  for (int event = 0; event < 20; ++event) EXPECT_NEAR(joint.Step(40.0), 40.6, 2e-3);
  joint.SetMeasuredAngles(kNaN);
  EXPECT_NEAR(joint.Step(40.0), 40.6, 2e-3);
  const double two[] = {1.0, 2.0};
  joint.loop().SetMeasuredAngles(two);  // of another hand
  EXPECT_NEAR(joint.Step(40.0), 40.6, 2e-3);
}

TEST(JointLoop, LeavesJointsThatSpringsDecideAsTheyAre) {
  TendonTransmission hand = SensingHand(2);
  hand.motor_names.resize(1);
  hand.coupling = {1.0, 1.0};
  hand.motor_of_joint = {"", ""};
  hand.counts_per_rad.resize(1);
  for (auto* counts : {&hand.center_counts, &hand.min_counts, &hand.max_counts}) counts->resize(1);
  JointLoopConfig config = PlainPi();
  config.proportional = 1.0;
  JointLoop loop(config, hand, kEvents_hz);
  const double target[] = {0.5, 0.6};
  const double measured[] = {0.1, 0.2};
  double corrected[2] = {};
  loop.SetMeasuredAngles(measured);
  loop.Step(target, corrected);
  EXPECT_THAT(corrected, testing::ElementsAre(0.5, 0.6));
}

TEST(JointLoop, UndoesFrictionOnAHandThatMeasuresNothing) {
  JointLoopConfig config = PlainPi();
  config.friction_deg = {2.0};
  JointLoop loop(config, CoupledHand(1), kEvents_hz);
  const double start = 0.5;
  loop.Reset({&start, 1});
  double corrected = 0.0;
  for (const double target : {0.6, 0.7, 0.4}) {
    const double direction = target > 0.5 ? 1.0 : -1.0;
    loop.Step({&target, 1}, {&corrected, 1});
    EXPECT_NEAR(corrected, target + 2.0 * kDeg * direction, 1e-12);
  }
}

TEST(JointLoop, RefusesAHandWithoutJointSensorsAndListsThatDoNotFit) {
  JointLoopConfig config = PlainPi();
  config.integral_per_s = 1.0;
  const auto problem = [&](const TendonTransmission& hand) {
    ControllerConfig of;
    of.joint_loop = config;
    try {
      Controller(of, PlainGlove(3), hand);
    } catch (const SettingError& error) {
      return std::string(error.what());
    }
    return std::string("none");
  };
  EXPECT_EQ(problem(SensingHand(3)), "none");
  EXPECT_EQ(problem(CoupledHand(3)),
            "joint_loop.kind: pi needs a hand that measures its joints (hand.joint_sensors); with "
            "proportional and integral_per_s 0 it compensates friction without");
  config.friction_deg = {1.0, 2.0};
  EXPECT_EQ(problem(SensingHand(3)),
            "joint_loop.friction_deg: has 2 values, must have 1 for all joints or 3, one for each");
  config.kind = JointLoopKind::kNone;
  EXPECT_EQ(problem(CoupledHand(3)), "none");
}

/// With all joints at 0.75 rad, which PlainGlove() gives 500 counts.
Controller Make(const ControllerConfig& config) {
  Controller controller(config, PlainGlove(3), SensingHand(3), {.event_period_ms = 1.0});
  const std::int32_t half_closed[] = {75512, 105512, 105512};
  controller.Reset(half_closed);
  return controller;
}

// Off, measured angles change nothing; on, they do, without allocating.
TEST(ControllerWithJointLoop, UsesMeasuredAnglesWithoutAllocating) {
  ControllerConfig config;
  Controller off = Make(config);
  Controller off_and_measured = Make(config);
  config.joint_loop = PlainPi();
  config.joint_loop.proportional = 1.0;
  Controller on = Make(config);
  const std::vector<double> glove(3, 500.0);
  const std::vector<double> measured(3, 0.6);
  const long before = AllocationCount();
  for (int k = 0; k < 100; ++k) {
    off_and_measured.TakeJointAngles(measured);
    on.TakeJointAngles(measured);
    const Command without = off.Step({.counts = glove});
    const Command unused = off_and_measured.Step({.counts = glove});
    const Command corrected = on.Step({.counts = glove});
    ASSERT_TRUE(std::ranges::equal(without.motor_counts, unused.motor_counts));
    if (k == 99) {
      EXPECT_GT(corrected.motor_counts[0], without.motor_counts[0]);
    }
  }
  EXPECT_EQ(AllocationCount(), before);
  EXPECT_NEAR(on.target_angle_rad()[0], 0.75, 1e-9) << "what is wanted is not what is sent";
}

// What the integral has learned stays when other settings are loaded, and is forgotten by Reset().
TEST(ControllerWithJointLoop, KeepsItsIntegralOverALoadAndForgetsItWithReset) {
  ControllerConfig config;
  config.joint_loop = PlainPi();
  config.joint_loop.integral_per_s = 1.0;
  Controller controller = Make(config);
  const std::vector<double> glove(3, 500.0);
  const std::vector<double> measured(3, 0.72);
  const std::vector<double> arrived(3, 0.75);
  std::vector<std::int32_t> counts;
  const auto step = [&](const std::vector<double>& angle_rad) {
    controller.TakeJointAngles(angle_rad);
    const auto command = controller.Step({.counts = glove}).motor_counts;
    counts.assign(command.begin(), command.end());
  };
  for (int k = 0; k < 1000; ++k) step(measured);
  const std::vector<std::int32_t> learned = counts;
  EXPECT_NEAR(learned[0], 512 + 1e5 * (0.75 + 0.03), 50);

  config.filters = {{MovingAverageConfig{}}};
  controller.Load(config);
  step(arrived);
  EXPECT_NEAR(counts[0], learned[0], 2);
  config.joint_loop.kind = JointLoopKind::kNone;
  controller.Load(config);
  for (int k = 0; k < 1000; ++k) step(arrived);
  EXPECT_EQ(counts[0], 512 + 75000);

  config.joint_loop.kind = JointLoopKind::kPi;
  controller.Load(config);
  for (int k = 0; k < 1000; ++k) step(measured);
  controller.Reset();
  for (int k = 0; k < 1000; ++k) step(arrived);
  EXPECT_EQ(counts[0], 512 + 75000);
}

}  // namespace
}  // namespace gauntlet::controller
