#include <gmock/gmock.h>

#include <algorithm>
#include <cstring>

#include "tests/hand/hand_fixture.h"
#include "tests/hand/sine_delay.h"
#include "tests/hand/small_hand.h"

namespace gauntlet::sim::testing {
namespace {

/// A new random posture every 100 ms, and commands that tremble by two counts: worse than any
/// glove.
struct RandomMotion {
  explicit RandomMotion(std::uint64_t seed) : random(seed, "motion") {}

  void Step(Hand& hand, int sample) {
    const controller::TendonTransmission& map = hand.hand_model().transmission();
    if (sample % 100 == 0) goal = CountsFor(map, RandomPosture(map, random));
    if (sample % 20 == 0) {
      std::vector<std::int32_t> counts = goal;
      for (std::int32_t& count : counts) count += static_cast<int>(random.Index(5)) - 2;
      hand.SetCommand(counts);
    }
    hand.Step();
  }
  RandomStream random;
  std::vector<std::int32_t> goal;
};

TEST(Motion, CablesNeverPushAndNothingWarnsInRandomMotion) {
  const auto model = MakeModel();
  Hand hand(model);
  std::vector<double> tension(model->cable_names().size());
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    hand.Reset(model->transmission().reference_angle_rad);
    RandomMotion motion(seed);
    double least = 1.0;
    for (int sample = 0; sample < 1500; ++sample) {
      motion.Step(hand, sample);
      hand.ReadCableTensions(tension);
      least = std::min(least, *std::min_element(tension.begin(), tension.end()));
    }
    EXPECT_TRUE(hand.health().ok) << "seed " << seed << ": " << hand.health().problem;
    EXPECT_EQ(least, 0.0) << "a motion as wild as this must slacken some cable";
  }
}

// Thrown from one posture to another, fingers reach their stops at full speed.
TEST(Motion, NoJointPassesItsStopsByADegree) {
  const auto model = MakeModel();
  const controller::TendonTransmission& map = model->transmission();
  Hand hand(model);
  RandomStream random(3, "stops");
  for (int posture = 0; posture < 60; ++posture) {
    hand.SetCommand(CountsFor(map, RandomPosture(map, random)));
    for (int i = 0; i < 150; ++i) {
      hand.Step();
      const std::vector<double> angle = JointAngles(hand);
      for (std::size_t joint = 0; joint < angle.size(); ++joint) {
        ASSERT_GT(angle[joint], map.joint_min_rad[joint] - 1.0 * kRadPerDeg)
            << map.joint_names[joint];
        ASSERT_LT(angle[joint], map.joint_max_rad[joint] + 1.0 * kRadPerDeg)
            << map.joint_names[joint];
      }
    }
  }
}

TEST(Motion, SameCommandsGiveTheSameBits) {
  const auto model = MakeModel();
  Hand first(model);
  Hand second(model);
  // The second hand has lived before: Reset() must leave no trace of it.
  RandomMotion other(7);
  for (int sample = 0; sample < 300; ++sample) other.Step(second, sample);
  first.Reset(HomePosture(model->transmission()));
  second.Reset(HomePosture(model->transmission()));
  RandomMotion one(8);
  RandomMotion two(8);
  for (int sample = 0; sample < 1000; ++sample) {
    one.Step(first, sample);
    two.Step(second, sample);
  }
  EXPECT_EQ(0, std::memcmp(first.data().qpos, second.data().qpos,
                           sizeof(double) * model->physics().model().nq));
  EXPECT_EQ(0, std::memcmp(first.data().qvel, second.data().qvel,
                           sizeof(double) * model->physics().model().nv));
}

TEST(Motion, TheSameModelHasTheSameHashAndAnotherSettingAnotherHash) {
  HandConfig stiff;
  stiff.cable.stiffness_scale = 1.5;
  HandConfig slow;
  slow.servo.numbers().no_load_speed_deg_s = 300.0;
  EXPECT_EQ(MakeModel()->Hash(), MakeModel()->Hash());
  EXPECT_NE(MakeModel()->Hash(), MakeModel(stiff)->Hash());
  EXPECT_NE(MakeModel()->Hash(), MakeModel(slow)->Hash());
}

// A full closing of the fingers takes 0.3 to 1 s (commercial prosthetic hands: 0.3 to 1 s).
TEST(Motion, FingersCloseInThreeTenthsToOneSecond) {
  Hand hand(MakeModel());
  const controller::TendonTransmission& map = hand.hand_model().transmission();
  std::vector<double> open = HomePosture(map);
  std::vector<double> closed = open;
  for (const char* finger : {"index", "middle", "ring", "little"}) {
    for (const char* joint : {"_mcp", "_pip"}) {
      const int channel = ChannelIndex(std::string(finger) + joint);
      open[channel] = 0.0;
      closed[channel] = map.joint_max_rad[channel];
    }
  }
  hand.Reset(open);
  hand.SetCommand(CountsFor(map, closed));
  int last = 0;
  for (int sample = 1; sample <= 1500; ++sample) {
    hand.Step();
    const std::vector<double> angle = JointAngles(hand);
    for (std::size_t i = 0; i < angle.size(); ++i) {
      if (std::abs(angle[i] - closed[i]) > 5.0 * kRadPerDeg) last = sample;
    }
  }
  EXPECT_GT(last, 300);
  EXPECT_LT(last, 1000);
}

// Steps of 20 deg, every channel alone.
TEST(Motion, StepResponsesOvershootByLessThanATenth) {
  Hand hand(MakeModel(StiffServos()));
  const controller::TendonTransmission& map = hand.hand_model().transmission();
  for (std::size_t channel = 0; channel < map.joint_names.size(); ++channel) {
    const std::vector<double> start = HomePosture(map);
    std::vector<double> goal = start;
    const double step = std::min(20.0 * kRadPerDeg, map.joint_max_rad[channel] - start[channel]);
    goal[channel] += step;
    hand.Reset(start);
    hand.SetCommand(CountsFor(map, goal));
    double highest = 0.0;
    for (int sample = 0; sample < 600; ++sample) {
      hand.Step();
      highest = std::max(highest, (JointAngles(hand)[channel] - start[channel]) / step);
    }
    EXPECT_LT(highest, 1.10) << map.joint_names[channel];
    EXPECT_GT(highest, 0.90) << map.joint_names[channel];
  }
}

// A frame is held for 20 ms, which delays by 10 ms; the servo's ratio of gains is 12 ms, and its
// dead band and friction and the load
// add less than 9 ms. What cables and joints add to frame and servo is less than
// 10 ms.
TEST(Motion, FollowsASineWithTheDelayOfFrameAndServo) {
  Hand hand(MakeModel(StiffServos()));
  for (const char* name : {"index_mcp", "middle_pip", "thumb_ip", "wrist_flexion",
                           "forearm_rotation", "elbow_flexion", "shoulder_flexion"}) {
    const DriveDelay delay = MeasureDelay(hand, ChannelIndex(name));
    EXPECT_NEAR(delay.spool.Milliseconds(), 10.0 + 12.0, 9.0) << name;
    EXPECT_NEAR(delay.joint.Milliseconds(), delay.spool.Milliseconds(), 10.0) << name;
  }
}

/// Energy of motion and gravity of what the engine moves, at this moment [J].
double BodyEnergy(const mjModel& physics, mjData& data) {
  mj_fwdPosition(&physics, &data);
  mj_fwdVelocity(&physics, &data);
  std::vector<double> momentum(physics.nv);
  mj_mulM(&physics, &data, momentum.data(), data.qvel);
  double energy = 0.5 * mju_dot(momentum.data(), data.qvel, physics.nv);
  for (int body = 1; body < physics.nbody; ++body) {
    energy -= physics.body_mass[body] * mju_dot3(physics.opt.gravity, data.xipos + 3 * body);
  }
  return energy;
}

double SpoolEnergy(const Hand& hand) {
  const std::vector<Drive>& drives = hand.hand_model().drives();
  std::vector<double> speed_rad_s(drives.size());
  hand.ReadSpoolSpeeds(speed_rad_s);
  double energy = 0.0;
  for (std::size_t i = 0; i < drives.size(); ++i) {
    energy += 0.5 * drives[i].spool.inertia_kg_m2 * speed_rad_s[i] * speed_rad_s[i];
  }
  return energy;
}

/// Energy that cables, gravity and motion hold together as the step begins that this does [J].
double StepWithEnergy(Hand& hand) {
  const mjModel& physics = hand.hand_model().physics().model();
  const std::unique_ptr<mjData, void (*)(mjData*)> before(
      mj_copyData(nullptr, &physics, &hand.data()), &mj_deleteData);
  const double of_spools = SpoolEnergy(hand);
  hand.Step();
  return BodyEnergy(physics, *before) + of_spools + hand.CableEnergy();
}

// A lever that falls freely, its cables slack, loses just what the damping of its hinge takes:
//
//     m g h + I omega^2 / 2 + integral of d omega^2 dt = constant
TEST(SmallHandMotion, AFreeFallLosesTheEnergyThatDampingTakes) {
  SmallHand small;
  small.config.cable.pretension_mm = 0.0;
  small.config.cable.slack_mm = {20.0};
  Hand hand(small.Make());
  hand.Reset(std::vector<double>{-0.9});
  const double sphere_inertia = 0.4 * small.mass_kg * 0.004 * 0.004;
  const double inertia =
      small.mass_kg * SmallHand::kLeverM * SmallHand::kLeverM + sphere_inertia + 1e-4;
  const double damping = 0.005;
  const HandModel& model = hand.hand_model();
  const int dof = model.physics().DofOf(model.joints()[0].dof);
  const auto angle = [&] { return Read(hand).joint_rad; };
  const auto height = [&] { return -SmallHand::kLeverM * std::sin(angle()); };
  const double start = small.mass_kg * small.gravity_m_s2 * height();
  double lost = 0.0;
  double before = 0.0;
  int steps = 0;
  while (angle() < 0.9) {
    ASSERT_LT(++steps, 1000) << "the lever does not fall";
    hand.Step();
    const double speed = hand.data().qvel[dof];
    lost += damping * 0.5 * (before * before + speed * speed) * 1e-3;
    before = speed;
  }
  const double end =
      small.mass_kg * small.gravity_m_s2 * height() + 0.5 * inertia * before * before;
  EXPECT_GT(lost, 0.02);
  EXPECT_NEAR(start - end, lost, 0.02 * lost);
  EXPECT_EQ(Read(hand).flexor_n + Read(hand).extensor_n, 0.0);
}

/// Motors without torque, the arm let go from a stretched posture: it falls and swings. The most
/// energy that it ever gains back, of what it has lost.
double ShareOfEnergyGained(double capstan_friction) {
  HandConfig config;
  for (ServoConfig* servo : {&config.servo, &config.arm_servo}) {
    servo->numbers().torque_scale = 1e-9;
  }
  config.cable.capstan_friction = capstan_friction;
  Hand hand(MakeModel(config));
  hand.Reset(HomePosture(hand.hand_model().transmission()));
  const double first = StepWithEnergy(hand);
  double lowest = first;
  double growth = 0.0;
  for (int sample = 0; sample < 1500; ++sample) {
    const double now = StepWithEnergy(hand);
    growth = std::max(growth, now - lowest);
    lowest = std::min(lowest, now);
  }
  EXPECT_GT(first - lowest, 0.5) << "the arm did not fall";
  return growth / (first - lowest);
}

TEST(Motion, EnergyDoesNotGrowWithoutInput) {
  for (double friction : {0.0, CableConfig{}.capstan_friction}) {
    EXPECT_LT(ShareOfEnergyGained(friction), 1e-6) << friction;
  }
}

}  // namespace
}  // namespace gauntlet::sim::testing
