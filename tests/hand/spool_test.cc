#include "sim/hand/spool.h"

#include <gmock/gmock.h>

#include <cmath>

#include "tests/hand/hand_fixture.h"
#include "tests/hand/small_hand.h"

namespace gauntlet::sim::testing {
namespace {

constexpr Spool kSpool{.inertia_kg_m2 = 3e-4, .damping_nm_s_rad = 1e-3, .dry_friction_nm = 8e-3};
constexpr double kStep_s = 1e-3;

TEST(Spool, StandsExactlyStillUntilDriveAndLoadDifferByMoreThanItsFriction) {
  SpoolState state{.angle_rad = 0.7};
  for (int i = 0; i < 10000; ++i) {
    const double drive = 0.2 + kSpool.dry_friction_nm * 0.999 * std::sin(0.01 * i);
    TurnSpool(kSpool, drive, 0.2, kStep_s, state);
    ASSERT_EQ(state.speed_rad_s, 0.0);
    ASSERT_EQ(state.angle_rad, 0.7);
  }
  TurnSpool(kSpool, 0.2 + 1.001 * kSpool.dry_friction_nm, 0.2, kStep_s, state);
  EXPECT_GT(state.speed_rad_s, 0.0);
}

// With friction alone it stops after inertia w / friction, having turned w t / 2, and rests there.
TEST(Spool, FrictionStopsItAndDoesNotTurnItBack) {
  Spool spool = kSpool;
  spool.damping_nm_s_rad = 0.0;
  for (double sign : {1.0, -1.0}) {
    SpoolState state{.angle_rad = 0.0, .speed_rad_s = 5.0 * sign};
    const double stop_s = spool.inertia_kg_m2 * 5.0 / spool.dry_friction_nm;
    int steps = 0;
    while (state.speed_rad_s != 0.0) {
      ASSERT_GT(state.speed_rad_s * sign, 0.0);
      ASSERT_LT(++steps, 1000);
      TurnSpool(spool, 0.0, 0.0, kStep_s, state);
    }
    EXPECT_NEAR(steps * kStep_s, stop_s, kStep_s);
    EXPECT_NEAR(state.angle_rad * sign, 0.5 * 5.0 * stop_s, 5.0 * kStep_s);
  }
}

// Far from the start: damping w = drive - load - friction, at any step.
TEST(Spool, SettlesWhereDampingAndFrictionTakeWhatDrives) {
  for (double step_s : {1e-4, 1e-3, 0.1}) {
    SpoolState state;
    for (int i = 0; i < 1e5; ++i) TurnSpool(kSpool, 0.03, 0.01, step_s, state);
    EXPECT_NEAR(state.speed_rad_s, (0.02 - kSpool.dry_friction_nm) / kSpool.damping_nm_s_rad, 1e-6);
  }
}

// Work of drive and load = what friction and damping took + the energy of motion, to first order
// in the step; and the step may only take more than that, never give.
TEST(Spool, KeepsTheBookOfItsEnergy) {
  SpoolState state;
  RandomStream random(3, "torque");
  double work = 0.0;
  double taken = 0.0;
  double drive = 0.0;
  constexpr double kShort_s = 1e-5;
  for (int i = 0; i < 200000; ++i) {
    if (i % 1000 == 0) drive = random.Uniform(-0.05, 0.05);
    TurnSpool(kSpool, drive, 0.0, kShort_s, state);
    const double turn = state.speed_rad_s * kShort_s;
    work += drive * turn;
    taken += kSpool.dry_friction_nm * std::abs(turn) +
             kSpool.damping_nm_s_rad * state.speed_rad_s * turn;
  }
  const double motion = 0.5 * kSpool.inertia_kg_m2 * state.speed_rad_s * state.speed_rad_s;
  EXPECT_GT(taken, 0.01);
  EXPECT_LE(motion, work - taken);
  EXPECT_NEAR(motion, work - taken, 2e-3 * taken);
}

// Cables that pull the drum either way by less than its friction do not creep it.
TEST(SpoolInTheHand, DryFrictionHoldsItAgainstTheCablesForEver) {
  SmallHand small;
  small.config.servo.numbers().torque_scale = 1e-9;
  std::string xml = small.Xml();
  const std::string armature = "armature=\"3e-4\"";
  // The weight turns the drum with 0.1 N m.
  xml.replace(xml.find(armature), armature.size(), armature + " frictionloss=\"0.2\"");
  Hand hand(MakeFromText(xml, small.config));
  const double before = Read(hand).spool_rad;
  StepTimes(hand, 2000);
  EXPECT_EQ(Read(hand).spool_rad, before);
  EXPECT_GT(Read(hand).extensor_n, 5.0) << "no cable pulled";
}

}  // namespace
}  // namespace gauntlet::sim::testing
