#include "sim/hand/cable.h"

#include <gmock/gmock.h>

#include "sim/base/error.h"
#include "tests/hand/hand_fixture.h"
#include "tests/hand/small_hand.h"

namespace gauntlet::sim::testing {
namespace {

SmallHand Fine() {
  SmallHand small;
  small.config.servo.numbers().resolution_bits = 18;
  small.config.servo.numbers().dead_band_deg = 0.0;
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

/// A cable of two ends, or of more places, that is moved and never let alone.
struct MovedCable {
  Cord cord = {.stiffness_n_m = 2e4, .damping_n_s_m = 0.0, .friction_coefficient = 0.1};
  double bend_rad = M_PI;
  double stretch_m = 1e-3;
  std::vector<CablePlace> places = {{}, {.bend_share = 1.0}};
  CableState state = {};

  /// Every place moves by so much, away from the cable.
  void Move(const std::vector<double>& way_m, double step_s = 1e-3) {
    for (std::size_t i = 0; i < places.size(); ++i) {
      places[i].speed_m_s = way_m[i] / step_s;
      stretch_m += way_m[i];
    }
    PullCable(cord, bend_rad, stretch_m, step_s, places, state);
  }
  double drum_n() const { return places.front().pull_n; }
  double far_n() const { return places.back().pull_n; }
  /// What the cable can give back [J].
  double Energy() const {
    const double stretch = std::max(0.0, stretch_m);
    return 0.5 * cord.stiffness_n_m * stretch * stretch +
           state.difference_n * state.difference_n / (8.0 * cord.stiffness_n_m);
  }
};

// The known value: 180 deg around a fixed rod at mu = 0.1 hold 1.37 times the load.
TEST(Cable, SlidesOverHalfATurnWithTheCapstanRatio) {
  MovedCable cable;
  for (int i = 0; i < 100; ++i) cable.Move({1e-4, -1e-4});
  EXPECT_NEAR(cable.drum_n() / cable.far_n(), 1.369, 5e-4);
  EXPECT_NEAR(0.5 * (cable.drum_n() + cable.far_n()), 20.0, 1e-9);
  for (int i = 0; i < 100; ++i) cable.Move({-1e-4, 1e-4});
  EXPECT_NEAR(cable.far_n() / cable.drum_n(), 1.369, 5e-4);
}

TEST(Cable, HoldsAtRestWhateverTheTime) {
  MovedCable cable;
  cable.Move({2e-5, 0.0});
  const double drum_n = cable.drum_n();
  EXPECT_GT(drum_n, cable.far_n() + 0.1);
  for (int i = 0; i < 1000; ++i) cable.Move({0.0, 0.0});
  EXPECT_EQ(cable.drum_n(), drum_n);
}

// While friction holds, the far end does not feel the drum, which stretches its half alone.
TEST(Cable, AnEndThatMovesALittlePullsItsOwnHalfOnly) {
  MovedCable cable;
  cable.Move({0.0, 0.0});
  const double far_n = cable.far_n();
  cable.Move({1e-5, 0.0});
  EXPECT_NEAR(cable.far_n(), far_n, 1e-9);
  EXPECT_NEAR(cable.drum_n() - far_n, 2.0 * cable.cord.stiffness_n_m * 1e-5, 1e-9);
}

TEST(Cable, TensionFallsExponentiallyWithTheBendOnItsWay) {
  MovedCable cable;
  cable.bend_rad = 12.0;
  cable.places = {{}, {.bend_share = 0.25}, {.bend_share = 0.5}, {.bend_share = 1.0}};
  for (int i = 0; i < 200; ++i) cable.Move({1e-5, 0.0, 0.0, -1e-5});
  for (const CablePlace& place : cable.places) {
    EXPECT_NEAR(place.pull_n / cable.drum_n(), std::exp(-0.1 * 12.0 * place.bend_share), 1e-3);
  }
}

// The law of energy, for every state and setting: what was put in, less what it still holds, is
// what friction and damping have taken, and that never becomes less. The mean of two moments' pulls
// makes the work of a spring exact.
TEST(Cable, NoMotionGetsEnergyOutOfIt) {
  RandomStream random(7, "cables");
  for (int trial = 0; trial < 100; ++trial) {
    MovedCable cable;
    cable.cord.stiffness_n_m = std::exp(random.Uniform(std::log(5e3), std::log(8e5)));
    cable.cord.friction_coefficient = random.Uniform(0.0, 0.5);
    cable.cord.damping_n_s_m = trial % 2 == 0 ? 0.0 : 1e-3 * cable.cord.stiffness_n_m;
    cable.bend_rad = random.Uniform(0.1, 14.0);
    cable.stretch_m = random.Uniform(0.0, 60.0) / cable.cord.stiffness_n_m;
    cable.places = {{}, {.bend_share = random.Uniform()}, {.bend_share = 1.0}};
    const double amplitude_m = random.Uniform(0.1, 3.0) * cable.stretch_m;
    double frequency[3], phase[3];
    for (int i = 0; i < 3; ++i) {
      frequency[i] = 1.0 + static_cast<double>(random.Index(3));
      phase[i] = random.Uniform(0.0, 2.0 * M_PI);
    }
    constexpr int kSteps = 10000;
    cable.Move({0.0, 0.0, 0.0});
    const double first = cable.Energy();
    double work = 0.0;
    double most = first;
    double taken = 0.0;
    for (int step = 0; step < 3 * kSteps; ++step) {
      std::vector<double> way_m(3);
      for (int i = 0; i < 3; ++i) {
        const double turn = 2.0 * M_PI * frequency[i] / kSteps;
        way_m[i] = amplitude_m *
                   (std::sin(turn * (step + 1) + phase[i]) - std::sin(turn * step + phase[i]));
      }
      const std::vector<CablePlace> before = cable.places;
      cable.Move(way_m);
      for (int i = 0; i < 3; ++i) {
        work += 0.5 * (before[i].pull_n + cable.places[i].pull_n) * way_m[i];
      }
      most = std::max(most, cable.Energy());
      const double now = work - (cable.Energy() - first);
      ASSERT_GT(now, taken - 1e-3 * most) << "trial " << trial << ", step " << step;
      taken = std::max(taken, now);
      ASSERT_GE(std::min(cable.drum_n(), cable.far_n()), 0.0);
    }
    if (cable.cord.friction_coefficient > 0.05) {
      EXPECT_GT(taken, 1e-3 * most);
    }
  }
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

// Within what the small steps of the servo shake: 4 %. Lifting needs exp(mu theta) times what the
// weight needs, letting down 1 / exp(mu theta).
TEST(SmallHandCable, CapstanFrictionIsExponentialInTheBend) {
  for (double mu : {0.05, 0.1, 0.2}) {
    const double ratio = std::exp(mu * SmallHand::BendAtZero());
    EXPECT_NEAR(RatioAfterCreepingFrom(0.5, mu), ratio, 0.04 * ratio);
    EXPECT_NEAR(RatioAfterCreepingFrom(-0.5, mu), 1.0 / ratio, 0.04 / ratio);
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
  slack.slack_mm = {1.0};
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

/// Two equal fingers beside each other, whose cables come from one floating pulley. The pulley is
/// in the palm, in front of a wrist that the cable passes once or in both branches.
std::string TwoFingersXml(bool wrist_behind_the_pulley) {
  std::string fingers;
  std::string branches;
  for (const double side : {0.02, -0.02}) {
    const std::string name = side > 0.0 ? "left" : "right";
    fingers += fmt::format(R"(
      <geom name="{0}_pulley" type="cylinder" fromto="0 {1} 0 0 {2} 0" size=".01" mass="0"/>
      <site name="{0}_below" pos="0 {3} -.03"/>
      <site name="{0}_fork" pos="-.05 {3} .02"/><site name="{0}_in" pos="-.02 {3} .006"/>
      <body name="{0}_finger" pos="0 {3} 0">
        <joint name="{0}" axis="0 1 0" range="0 80" limited="true" stiffness=".12" springref="-17"
               damping=".004" armature="1e-4"/>
        <geom type="capsule" fromto=".01 0 0 .06 0 0" size=".007" mass=".02"/>
        <site name="{0}_out" pos=".02 0 .006"/>
      </body>)",
                           name, side - 0.006, side + 0.006, side);
    branches += fmt::format(R"(<pulley divisor="2"/>{1}<site site="{0}_fork"/><site site="{0}_in"/>
      <geom geom="{0}_pulley" sidesite="{0}_below"/><site site="{0}_out"/>)",
                            name, wrist_behind_the_pulley ? R"(<site site="forearm"/>)" : "");
  }
  return fmt::format(R"(
<mujoco>
  <compiler angle="degree"/>
  <option timestep="0.001" gravity="0 0 0"/>
  <worldbody>
    <site name="drum" pos="-.2 0 -.01"/><site name="forearm" pos="-.12 0 .01"/>
    <body name="spool" pos="-.2 0 0">
      <joint name="fingers_spool" axis="0 1 0" armature="3e-4" damping="1e-3"/>
      <geom name="fingers_drum" type="cylinder" size=".01 .002" euler="90 0 0" mass=".001"/>
    </body>
    <body name="palm">
      <joint name="wrist" pos="-.1 0 0" axis="0 1 0" range="-5 5" limited="true" stiffness="9"
             damping=".1"/>
      <geom type="box" size=".02 .03 .01" pos="-.04 0 0" mass=".1"/>
      <site name="palm" pos="-.08 0 .01"/>{}
    </body>
  </worldbody>
  <tendon>
    <spatial name="fingers_flexor" stiffness="3e4" damping="20">
      <site site="drum"/><site site="forearm"/>{}{}
    </spatial>
  </tendon>
  <actuator><motor name="fingers" joint="fingers_spool" ctrllimited="true" ctrlrange="-.45 .45"/></actuator>
</mujoco>)",
                     fingers, wrist_behind_the_pulley ? "" : R"(<site site="palm"/>)", branches);
}

TEST(DividedCable, TurnsEqualFingersAlike) {
  HandConfig config = StiffServos();
  config.cable.capstan_friction = 0.1;
  const auto model = MakeFromText(TwoFingersXml(false), config);
  const Cable& cable = model->drives()[0].cables[0];
  ASSERT_EQ(cable.branches.size(), 3u);
  EXPECT_EQ(cable.branches[1].parent, 0);
  EXPECT_EQ(cable.branches[2].parent, 0);
  EXPECT_NEAR(cable.branches[1].bend_rad, cable.branches[2].bend_rad, 1e-9);
  EXPECT_GT(cable.branches[1].bend_rad, cable.branches[0].bend_rad + 0.5);
  const auto& map = model->transmission();
  const auto place = [&](const char* name) {
    return std::ranges::find(map.joint_names, name) - map.joint_names.begin();
  };
  ASSERT_EQ(map.joint_names.size(), 3u);
  Hand hand(model);
  double low = 10.0;
  double high = -10.0;
  std::vector<double> angle_rad(3);
  for (int tick = 0; tick < 3000; ++tick) {
    const std::int32_t counts =
        map.center_counts[0] + static_cast<std::int32_t>(300.0 * std::sin(0.005 * tick));
    hand.SetCommand({&counts, 1});
    hand.Step();
    hand.ReadJointAngles(angle_rad);
    ASSERT_NEAR(angle_rad[place("left")], angle_rad[place("right")], 1e-9) << tick;
    low = std::min(low, angle_rad[place("left")]);
    high = std::max(high, angle_rad[place("left")]);
  }
  EXPECT_TRUE(hand.health().ok) << hand.health().problem;
  EXPECT_GT(high - low, 0.2);
}

TEST(DividedCable, WithFrictionIsRefusedWhereTwoBranchesPassOneJoint) {
  HandConfig config = StiffServos();
  config.cable.capstan_friction = 0.0;
  const auto model = MakeFromText(TwoFingersXml(true), config);
  EXPECT_EQ(model->drives()[0].cables[0].crossings.size(), 3u);  // the wrist once
  config.cable.capstan_friction = 0.1;
  try {
    MakeFromText(TwoFingersXml(true), config);
    ADD_FAILURE() << "not refused";
  } catch (const UserError& error) {
    EXPECT_EQ(error.key(), "hand.cable.capstan_friction");
    EXPECT_THAT(error.problem(), ::testing::HasSubstr("'wrist'"));
  }
}

}  // namespace
}  // namespace gauntlet::sim::testing
