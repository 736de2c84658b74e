#include "sim/hand/cable.h"

#include <gmock/gmock.h>

#include "tests/hand/hand_fixture.h"
#include "tests/hand/small_hand.h"

namespace gauntlet::sim::testing {
namespace {

SmallHand Fine() {
  SmallHand small;
  small.config.servo.resolution_bits = 18;
  small.config.servo.dead_band_deg = 0.0;
  small.config.cable.capstan_friction = 0.0;
  small.config.cable.pretension_mm = 0.0;
  return small;
}

TEST(Cable, PullsInProportionToStretchAndNeverPushes) {
  EXPECT_DOUBLE_EQ(CableTension(1e4, 0.0, 1e-3, 0.0), 10.0);
  EXPECT_EQ(CableTension(1e4, 10.0, -1e-3, 1.0), 0.0);
  EXPECT_EQ(CableTension(1e4, 10.0, 0.0, 1.0), 0.0);
  // Shortening fast it may lose its tension, not push.
  EXPECT_EQ(CableTension(1e4, 10.0, 1e-3, -100.0), 0.0);
  EXPECT_DOUBLE_EQ(CableTension(1e4, 10.0, 1e-3, -0.1), 9.0);
}

TEST(Cable, FrictionBuildsUpWithTravelAndHoldsAtRest) {
  double state = AdvanceFriction(0.0, 20.0 * kPreslidingTravelM);
  EXPECT_NEAR(state, 1.0, 1e-8);
  EXPECT_EQ(AdvanceFriction(state, 0.0), state);
  // Steps do not matter, only the travel: the law knows no time.
  double in_steps = state;
  for (int i = 0; i < 10; ++i) in_steps = AdvanceFriction(in_steps, -0.1 * kPreslidingTravelM);
  EXPECT_NEAR(in_steps, AdvanceFriction(state, -kPreslidingTravelM), 1e-12);
  EXPECT_NEAR(AdvanceFriction(state, -20.0 * kPreslidingTravelM), -1.0, 1e-8);
}

// The known value: 180 deg around a fixed rod at mu = 0.1 hold 1.37 times the load.
TEST(Cable, CapstanRatioOfHalfATurn) {
  EXPECT_NEAR(CapstanRatio(0.1, M_PI, 1.0), 1.369, 5e-4);
  EXPECT_DOUBLE_EQ(CapstanRatio(0.1, M_PI, -1.0), 1.0 / CapstanRatio(0.1, M_PI, 1.0));
}

// The weight pulls the extensor, which bears it alone: stretch = tension / k.
TEST(SmallHandCable, StretchesByTensionOverStiffness) {
  for (double stiffness : {5e3, 2e4}) {
    SmallHand small = Fine();
    small.stiffness_n_m = stiffness;
    const auto model = small.Make();
    Hand hand(model);
    Hold(hand, JointCommand(*model, 0.0), 3000);
    const SmallHandReading at = Read(hand);
    const double tension = small.WeightTorque(at.joint_rad) / SmallHand::kPulleyM;
    EXPECT_NEAR(at.extensor_n, tension, 1e-3 * tension);
    EXPECT_EQ(at.flexor_n, 0.0);
    const double stretch = SmallHand::kPulleyM * at.joint_rad - small.drum_radius_m * at.spool_rad;
    EXPECT_NEAR(stretch, tension / stiffness, 2e-3 * tension / stiffness);
  }
}

/// From one joint angle to another so slowly that inertia and damping do not count.
void Creep(Hand& hand, double from_rad, double to_rad) {
  constexpr int kSteps = 600;
  for (int i = 0; i <= kSteps; ++i) {
    Hold(hand, JointCommand(hand.hand_model(), from_rad + (to_rad - from_rad) * i / kSteps), 20);
  }
}

/// Tension at the drum over the tension that holds the weight, after creeping to angle 0 from
/// `from_rad`.
double RatioAfterCreepingFrom(double from_rad, double mu) {
  SmallHand small = Fine();
  small.config.cable.capstan_friction = mu;
  Hand hand(small.Make());
  hand.Reset(std::vector<double>{from_rad});
  Creep(hand, from_rad, 0.0);
  const SmallHandReading at = Read(hand);
  return at.extensor_n / (small.WeightTorque(at.joint_rad) / SmallHand::kPulleyM);
}

// Within what the small steps of the servo shake: 3 %. Lifting needs exp(mu theta) times what the
// weight needs, letting down 1 / exp(mu theta).
TEST(SmallHandCable, CapstanFrictionIsExponentialInTheBend) {
  for (double mu : {0.05, 0.1, 0.2}) {
    const double ratio = std::exp(mu * SmallHand::BendAtZero());
    EXPECT_NEAR(RatioAfterCreepingFrom(0.5, mu), ratio, 0.03 * ratio);
    EXPECT_NEAR(RatioAfterCreepingFrom(-0.5, mu), 1.0 / ratio, 0.03 / ratio);
  }
  EXPECT_NEAR(RatioAfterCreepingFrom(0.5, 0.0), 1.0, 2e-3);
}

/// How far the joint is left behind when the spool creeps to and fro by 20 deg, without gravity
/// [rad]: the width of the hysteresis.
double LostMotion(const CableConfig& cable) {
  SmallHand small = Fine();
  small.gravity_m_s2 = 0.0;
  small.config.cable = cable;
  Hand hand(small.Make());
  const double turn = 20.0 * kRadPerDeg;
  Creep(hand, 0.0, turn);
  Creep(hand, turn, 0.0);
  const double from_above = Read(hand).joint_rad;
  Creep(hand, 0.0, -turn);
  Creep(hand, -turn, 0.0);
  return from_above - Read(hand).joint_rad;
}

TEST(SmallHandCable, SlackAndBacklashLoseMotion) {
  CableConfig tight;
  tight.capstan_friction = 0.0;
  EXPECT_NEAR(LostMotion(tight), 0.0, 5e-4);

  // Both cables 1 mm too long: the joint floats over 2 mm of cable.
  CableConfig slack = tight;
  slack.pretension_mm = 0.0;
  slack.slack_mm = 1.0;
  EXPECT_NEAR(LostMotion(slack), 2e-3 / SmallHand::kPulleyM, 2e-3);

  // A drum with 6 deg of play, as large as the pulley.
  CableConfig play = tight;
  play.backlash_deg = 6.0;
  EXPECT_NEAR(LostMotion(play), 6.0 * kRadPerDeg, 2e-3);

  // Friction holds the drum on its cables while the shaft turns through the play: both add up.
  CableConfig rubbing;
  rubbing.capstan_friction = 0.1;
  const double rubbed = LostMotion(rubbing);
  EXPECT_GT(rubbed, 0.01);
  rubbing.backlash_deg = 6.0;
  EXPECT_NEAR(LostMotion(rubbing), rubbed + 6.0 * kRadPerDeg, 0.1 * rubbed);
}

TEST(SmallHandCable, BendsAreFoundInTheModel) {
  const auto model = Fine().Make();
  const Cable& cable = model->drives()[0].cables[0];
  ASSERT_EQ(cable.crossings.size(), 1u);
  EXPECT_NEAR(cable.crossings[0].moment_arm_m, -SmallHand::kPulleyM, 1e-9);
  EXPECT_NEAR(cable.crossings[0].bend_rad, SmallHand::BendAtZero(), 1e-6);
}

}  // namespace
}  // namespace gauntlet::sim::testing
