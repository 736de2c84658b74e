#include "sim/hand/cable_geometry.h"

#include <gmock/gmock.h>

#include "controller/tendon_map.h"
#include "sim/hand/mujoco_versions.h"
#include "sim/hand/physics_model.h"
#include "tests/hand/hand_fixture.h"
#include "tests/hand/small_hand.h"

namespace gauntlet::sim::testing {
namespace {

using Data = std::unique_ptr<mjData, void (*)(mjData*)>;

Data DataOf(const mjModel& model) { return {mj_makeData(&model), &mj_deleteData}; }

/// The farthest that spans are from what the engine finds in the posture of `data`.
struct Difference {
  double length_m = 0.0;
  double arm_m = 0.0;
  double rate_m_s = 0.0;

  void Compare(const HandModel& hand, const mjData& data) {
    const PhysicsModel& physics = hand.physics();
    std::vector<double> qpos(physics.model().nq);
    std::vector<double> qvel(physics.model().nv);
    physics.CopyPositions(data.qpos, qpos.data());
    for (int dof = 0; dof < hand.model().nv; ++dof) {
      if (physics.DofOf(dof) >= 0) qvel[physics.DofOf(dof)] = data.qvel[dof];
    }
    std::vector<double> arm;
    for (const Drive& drive : hand.drives()) {
      for (const Cable& cable : drive.cables) {
        arm.resize(cable.crossings.size());
        double rate = 0.0;
        const double length = MeasureCable(cable, qpos.data(), qvel.data(), arm, rate);
        length_m = std::max(length_m, std::abs(length - data.ten_length[cable.tendon]));
        double rate_by_engine = 0.0;
        for (int dof = 0; dof < hand.model().nv; ++dof) {
          const double by_engine = MomentArm(hand.model(), data, cable.tendon, dof);
          rate_by_engine += by_engine * data.qvel[dof];
          double by_spans = 0.0;
          for (std::size_t i = 0; i < arm.size(); ++i) {
            if (cable.crossings[i].dof == physics.DofOf(dof)) by_spans = arm[i];
          }
          arm_m = std::max(arm_m, std::abs(by_spans - by_engine));
        }
        rate_m_s = std::max(rate_m_s, std::abs(rate - rate_by_engine));
      }
    }
  }
};

TEST(CableGeometry, SaysWhatTheEngineSaysInTenThousandPostures) {
  const auto hand = MakeModel();
  ASSERT_FALSE(hand->engine_measures_cables());
  const Data data = DataOf(hand->model());
  const controller::TendonTransmission& map = hand->transmission();
  RandomStream random(3, "postures");
  Difference difference;
  for (int posture = 0; posture < 10'000; ++posture) {
    std::vector<double> angle = RandomPosture(map, random);
    for (double& value : angle) value += random.Uniform(-0.08, 0.08);  // joints pass their stops
    for (int dof = 0; dof < hand->model().nv; ++dof) data->qvel[dof] = random.Uniform(-5.0, 5.0);
    SetPosture(*hand, angle, std::vector<double>(hand->drives().size()), *data);
    difference.Compare(*hand, *data);
  }
  EXPECT_LT(difference.length_m, 1e-11);
  EXPECT_LT(difference.arm_m, 1e-10);
  EXPECT_LT(difference.rate_m_s, 1e-9);
}

/// A lever that turns so far that its cables leave the pulley, guides at different heights.
std::string FarTurningHand() {
  std::string xml = SmallHand{}.Xml();
  const auto replace = [&xml](const std::string& from, const std::string& to) {
    const std::size_t at = xml.find(from);
    ASSERT_NE(at, std::string::npos) << from;
    xml.replace(at, from.size(), to);
  };
  replace("-60 60", "-130 130");
  replace("\"flexor_out\" pos=\"0.02 0", "\"flexor_out\" pos=\"0.02 0.003");
  return xml;
}

// Where the arc is 0 length and moment arm go on without a jump.
TEST(CableGeometry, HoldsWhereACableLeavesItsPulley) {
  if (mj_version() >= 4'000'000) GTEST_SKIP() << "a guide passes the place opposite of a side site";
  const auto hand = MakeFromText(FarTurningHand(), {});
  ASSERT_FALSE(hand->engine_measures_cables());
  const Data data = DataOf(hand->model());
  const CableSpan& span = hand->drives()[0].cables[0].spans.at(0);
  int on_pulley = 0;
  int steps = 0;
  Difference difference;
  SpanLength before = span.At(-2.3);
  for (double angle = -2.3 + 1e-4; angle < 2.3; angle += 1e-4) {
    const SpanLength now = span.At(angle);
    ASSERT_NEAR(now.arm_m, before.arm_m, 3e-6) << angle;
    ASSERT_NEAR(now.length_m - before.length_m, 0.5e-4 * (now.arm_m + before.arm_m), 1e-9) << angle;
    before = now;
    ++steps;
    on_pulley += span.arc_m + span.radius_m * (angle - span.reference_rad) > 0.0;
    if (steps % 10 != 0) continue;
    SetPosture(*hand, std::vector<double>{angle}, std::vector<double>(1), *data);
    difference.Compare(*hand, *data);
  }
  EXPECT_GT(on_pulley, steps / 10);
  EXPECT_LT(on_pulley, 9 * steps / 10);
  EXPECT_LT(difference.length_m, 1e-9);
  EXPECT_LT(difference.arm_m, 1e-8);
}

/// A lever whose joints cross in one point; each cable runs past both in one straight line.
constexpr const char* kTwoJointsAtOnce = R"(
<mujoco>
  <compiler angle="degree"/>
  <worldbody>
    <site name="down_drum" pos="-.1 0 -.01"/> <site name="up_drum" pos="-.1 0 .01"/>
    <site name="down_in" pos="-.02 .004 -.01"/> <site name="up_in" pos="-.02 .004 .01"/>
    <body name="spool" pos="-.1 0 0">
      <joint name="tilt_spool" axis="0 1 0" armature="3e-4" damping="1e-3"/>
      <geom name="tilt_drum" type="cylinder" size=".01 .002" euler="90 0 0" mass=".001"/>
    </body>
    <body name="lever">
      <joint name="tilt" axis="0 1 0" limited="true" range="-30 30" armature="1e-4" damping=".005"/>
      <joint name="pan" axis="0 0 1" limited="true" range="-20 20" armature="1e-4" damping=".005"
             stiffness=".5"/>
      <geom type="capsule" fromto="0 0 0 .05 0 0" size=".004" mass=".02"/>
      <site name="down_out" pos=".02 0 -.01"/> <site name="up_out" pos=".02 0 .01"/>
    </body>
  </worldbody>
  <tendon>
    <spatial name="tilt_flexor" stiffness="1e4" damping="5">
      <site site="down_drum"/><site site="down_in"/><site site="down_out"/>
    </spatial>
    <spatial name="tilt_extensor" stiffness="1e4" damping="5">
      <site site="up_drum"/><site site="up_in"/><site site="up_out"/>
    </spatial>
  </tendon>
  <actuator>
    <motor name="tilt" joint="tilt_spool" ctrllimited="true" ctrlrange="-.45 .45"/>
  </actuator>
</mujoco>)";

TEST(CableGeometry, LeavesToTheEngineWhatDependsOnTwoJointsAtOnce) {
  const auto model = MakeFromText(kTwoJointsAtOnce, {});
  EXPECT_TRUE(model->engine_measures_cables());
  EXPECT_EQ(model->physics().model().ntendon, 2);
  const controller::TendonTransmission& map = model->transmission();
  Hand hand(model);
  std::vector<double> angle(map.joint_names.size());
  angle[0] = 0.3;
  std::vector<double> spool(1);
  controller::TendonMap(map, true).ToSpoolAngles(angle, spool);
  const auto counts = static_cast<std::int32_t>(std::lround(map.ToCounts(0, spool[0])));
  hand.SetCommand({&counts, 1});
  StepTimes(hand, 500);
  EXPECT_TRUE(hand.health().ok) << hand.health().problem;
  std::vector<double> reached(map.joint_names.size());
  hand.ReadJointAngles(reached);
  EXPECT_NEAR(reached[0], 0.3, 0.05);
}

// What the physics model lacks has no force. Spools are parts of what carries them; in the whole
// model they may turn against it, which takes 3e-4 of the drum's inertia about its own axis.
TEST(PhysicsModel, AcceleratesAsTheWholeModelDoes) {
  for (const Contact contact : {Contact::kNone, Contact::kHand, Contact::kObject}) {
    HandConfig config;
    config.contact = contact;
    const auto hand = MakeModel(config);
    const mjModel& whole = hand->model();
    const mjModel& physics = hand->physics().model();
    EXPECT_EQ(physics.ntendon, 0);
    if (kModelsCanBeCut) {
      EXPECT_LT(physics.ngeom, whole.ngeom / 4);
      EXPECT_EQ(physics.nv, whole.nv - 18);
      EXPECT_EQ(physics.nbody, whole.nbody - 18);
    }
    EXPECT_NEAR(mj_getTotalmass(&physics), mj_getTotalmass(&whole), 1e-12);
    const Data of_whole = DataOf(whole);
    const Data of_physics = DataOf(physics);
    RandomStream random(4, "postures");
    int touching = 0;
    for (int posture = 0; posture < 50; ++posture) {
      const std::vector<double> angle = RandomPosture(hand->transmission(), random);
      SetPosture(*hand, angle, std::vector<double>(hand->drives().size()), *of_whole);
      hand->physics().CopyPositions(of_whole->qpos, of_physics->qpos);
      for (int dof = 0; dof < whole.nv; ++dof) {
        const int here = hand->physics().DofOf(dof);
        if (here < 0) continue;
        of_whole->qvel[dof] = of_physics->qvel[here] = random.Uniform(-1.0, 1.0);
        of_whole->qfrc_applied[dof] = of_physics->qfrc_applied[here] = random.Uniform(-0.1, 0.1);
      }
      mj_forward(&whole, of_whole.get());
      mj_forward(&physics, of_physics.get());
      touching += of_physics->ncon;
      ASSERT_EQ(of_physics->ncon, of_whole->ncon);
      for (int dof = 0; dof < whole.nv; ++dof) {
        const int here = hand->physics().DofOf(dof);
        if (here < 0) continue;
        const double expected = of_whole->qacc[dof];
        ASSERT_NEAR(of_physics->qacc[here], expected, 1e-3 + 1e-4 * std::abs(expected)) << dof;
      }
    }
    EXPECT_EQ(touching > 0, contact != Contact::kNone);
  }
}

TEST(PhysicsModel, MovesTheSameWithSpoolsThatStandStill) {
  const auto hand = MakeModel();
  const mjModel& whole = hand->model();
  const PhysicsModel held(whole, hand->drives(), false, PhysicsModel::Spools::kStandStill);
  ASSERT_EQ(held.model().nv, whole.nv);
  const Data of_held = DataOf(held.model());
  const Data of_hand = DataOf(hand->physics().model());
  RandomStream random(5, "forces");
  std::vector<double> force_nm(whole.nv);
  for (double& force : force_nm) force = random.Uniform(-0.1, 0.1);
  for (int dof = 0; dof < whole.nv; ++dof) {
    ASSERT_EQ(held.DofOf(dof) < 0, hand->physics().DofOf(dof) < 0);
    of_held->qfrc_applied[dof] = force_nm[dof];
    if (held.DofOf(dof) < 0) continue;
    ASSERT_EQ(held.DofOf(dof), dof);
    of_hand->qfrc_applied[hand->physics().DofOf(dof)] = force_nm[dof];
  }
  for (int step = 0; step < 100; ++step) {
    mj_step(&held.model(), of_held.get());
    mj_step(&hand->physics().model(), of_hand.get());
  }
  double fastest = 0.0;
  for (int dof = 0; dof < whole.nv; ++dof) {
    const int here = hand->physics().DofOf(dof);
    const double expected = here < 0 ? 0.0 : of_hand->qvel[here];
    EXPECT_NEAR(of_held->qvel[dof], expected, 1e-5) << dof;
    fastest = std::max(fastest, std::abs(expected));
  }
  EXPECT_GT(fastest, 1.0);
}

}  // namespace
}  // namespace gauntlet::sim::testing
