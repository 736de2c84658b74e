// The hand as MJCF for simulation without Gauntlet: the same cables and the same bodies.
#include "sim/hand/mjcf_export.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "sim/base/data_folder.h"
#include "sim/base/random.h"
#include "sim/hand/cable_geometry.h"
#include "sim/hand/mujoco_versions.h"
#include "sim/hand/physics_model.h"
#include "tests/hand/compiled_text.h"
#include "tests/hand/hand_fixture.h"
#include "tests/hand/small_hand.h"

namespace gauntlet::sim::testing {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using ExportData = std::unique_ptr<mjData, void (*)(mjData*)>;

/// A hand and what becomes of it.
struct Exported {
  explicit Exported(const HandConfig& config, const std::string& name = "a test")
      : hand(config),
        mjcf(ExportMjcf(hand, name, "parts")),
        model(Compiled(mjcf.text)),
        data(model ? mj_makeData(model.get()) : nullptr, &mj_deleteData) {}

  /// Starts at the keyframe, with this angle of all motors.
  void Settle(double control_rad, double duration_s) {
    mj_resetDataKeyframe(model.get(), data.get(), 0);
    std::fill_n(data->ctrl, model->nu, control_rad);
    while (data->time < duration_s) mj_step(model.get(), data.get());
  }
  /// The joints of the model, with their numbers in that of the hand.
  std::vector<std::pair<int, int>> Joints() const {
    std::vector<std::pair<int, int>> joints;
    for (int joint = 0; joint < model->njnt; ++joint) {
      const char* const name = mj_id2name(model.get(), mjOBJ_JOINT, joint);
      joints.emplace_back(joint, mj_name2id(&hand.model(), mjOBJ_JOINT, name));
    }
    return joints;
  }
  /// `whole`: of the model with spools.
  void TakePositions(const std::vector<double>& whole) {
    for (const auto& [joint, in_hand] : Joints()) {
      data->qpos[model->jnt_qposadr[joint]] = whole[hand.model().jnt_qposadr[in_hand]];
    }
  }
  double Angle(const std::string& joint) const {
    const int index = mj_name2id(model.get(), mjOBJ_JOINT, joint.c_str());
    return data->qpos[model->jnt_qposadr[index]];
  }

  HandModel hand;
  ExportedMjcf mjcf;
  CompiledText model;
  ExportData data;
};

HandConfig ReadyHand(const char* file) {
  HandConfig config;
  config.model_path = (DataFolder("models") / file).string();
  return config;
}

HandConfig WithObject() {
  HandConfig config;
  config.contact = Contact::kObject;
  config.object = {.mass_kg = 0.41, .diameter_mm = 50.0, .friction = 0.7};
  return config;
}

class MjcfExport : public ::testing::TestWithParam<HandConfig> {};

// Lengths and moments as a trial takes them.
TEST_P(MjcfExport, CablesHaveTheLengthsAndMomentsOfATrial) {
  Exported exported(GetParam());
  ASSERT_NE(exported.model, nullptr);
  const HandModel& hand = exported.hand;
  const mjModel& physics = hand.physics().model();
  ASSERT_EQ(exported.model->nu, std::ssize(hand.cable_names()));
  RandomStream random(7, "postures");
  const std::vector<double> still(physics.nv);
  for (int posture = 0; posture < 300; ++posture) {
    const std::vector<double> whole = PostureOf(
        hand.model(), hand.joints(), RandomPosture(hand.transmission(), random), hand.followers());
    std::vector<double> qpos(physics.nq);
    hand.physics().CopyPositions(whole.data(), qpos.data());
    exported.TakePositions(whole);
    mj_forward(exported.model.get(), exported.data.get());
    for (const Drive& drive : hand.drives()) {
      for (const Cable& cable : drive.cables) {
        std::vector<double> arm(cable.crossings.size());
        double rate = 0.0;
        const double length = MeasureCable(cable, qpos.data(), still.data(), arm, rate);
        const int tendon = mj_name2id(exported.model.get(), mjOBJ_TENDON, cable.name.c_str());
        ASSERT_GE(tendon, 0) << cable.name;
        ASSERT_NEAR(exported.data->ten_length[tendon], length, 1e-9) << cable.name;
        std::vector<double> by_dof(physics.nv);
        for (std::size_t i = 0; i < arm.size(); ++i) by_dof[cable.crossings[i].dof] += arm[i];
        for (const auto& [joint, in_hand] : exported.Joints()) {
          const int dof = exported.model->jnt_dofadr[joint];
          const int in_physics = hand.physics().DofOf(hand.model().jnt_dofadr[in_hand]);
          ASSERT_NEAR(MomentArm(*exported.model, *exported.data, tendon, dof), by_dof[in_physics],
                      1e-9)
              << cable.name << " at " << dof;
        }
      }
    }
  }
}

// Without cables and motors both fall and swing alike. Linkages and stops are left out: the engine
// makes them as soft as the inertia that the model was compiled with, which a trial changes later.
TEST_P(MjcfExport, BodiesMoveAsInATrial) {
  Exported exported(GetParam());
  ASSERT_NE(exported.model, nullptr);
  if (!kModelsCanBeCut) GTEST_SKIP() << "spools are parts of the physics model";
  const mjModel& physics = exported.hand.physics().model();
  ASSERT_EQ(exported.model->nq, physics.nq);
  const ExportData data(mj_makeData(&physics), &mj_deleteData);
  exported.model->opt.disableflags |= mjDSBL_ACTUATION | mjDSBL_CONSTRAINT;
  mjModel free = physics;  // shares its arrays
  free.opt.disableflags |= mjDSBL_CONSTRAINT;
  EXPECT_EQ(exported.model->opt.timestep, physics.opt.timestep);
  RandomStream random(8, "motions");
  for (int posture = 0; posture < 50; ++posture) {
    const std::vector<double> whole =
        PostureOf(exported.hand.model(), exported.hand.joints(),
                  RandomPosture(exported.hand.transmission(), random), exported.hand.followers());
    exported.hand.physics().CopyPositions(whole.data(), data->qpos);
    for (int dof = 0; dof < physics.nv; ++dof) data->qvel[dof] = random.Uniform(-3.0, 3.0);
    std::copy_n(data->qpos, physics.nq, exported.data->qpos);
    std::copy_n(data->qvel, physics.nv, exported.data->qvel);
    mj_forward(&free, data.get());
    mj_forward(exported.model.get(), exported.data.get());
    for (int dof = 0; dof < physics.nv; ++dof) {
      ASSERT_NEAR(exported.data->qacc[dof], data->qacc[dof],
                  1e-6 + 1e-7 * std::abs(data->qacc[dof]))
          << dof;
    }
  }
}

TEST_P(MjcfExport, CablesPullWithTheirPretensionAtControlZero) {
  Exported exported(GetParam());
  ASSERT_NE(exported.model, nullptr);
  exported.Settle(0.0, 0.0);
  mj_forward(exported.model.get(), exported.data.get());
  for (const Drive& drive : exported.hand.drives()) {
    for (const Cable& cable : drive.cables) {
      const int actuator = mj_name2id(exported.model.get(), mjOBJ_ACTUATOR, cable.name.c_str());
      ASSERT_GE(actuator, 0) << cable.name;
      EXPECT_NEAR(exported.data->actuator_force[actuator], -cable.pretension_n, 1e-6);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(OfReadyModels, MjcfExport,
                         ::testing::Values(HandConfig(), WithObject(),
                                           ReadyHand("five_motor_hand.xml")));

// The cable that a spool winds shortens by angle times radius; the other one gives way.
TEST(ExportedHand, BothCablesOfAMotorTurnItsJointByTheAngleOfTheSpool) {
  Exported exported{FrictionFree()};
  ASSERT_NE(exported.model, nullptr);
  const controller::TendonTransmission& map = exported.hand.transmission();
  exported.Settle(0.0, 1.0);
  const double before = exported.Angle("index_mcp");
  const std::size_t motor =
      std::ranges::find(map.motor_names, "index_mcp") - map.motor_names.begin();
  const std::size_t joint =
      std::ranges::find(map.joint_names, "index_mcp") - map.joint_names.begin();
  for (const char* const cable : {"index_mcp_flexor", "index_mcp_extensor"}) {
    exported.data->ctrl[mj_name2id(exported.model.get(), mjOBJ_ACTUATOR, cable)] = 0.4;
  }
  while (exported.data->time < 2.0) mj_step(exported.model.get(), exported.data.get());
  const double turned = exported.Angle("index_mcp") - before;
  EXPECT_NEAR(turned, 0.4 / map.coupling[motor * map.joint_names.size() + joint], 0.01);
  for (int i = 0; i < exported.model->nu; ++i) EXPECT_LE(exported.data->actuator_force[i], 0.0);
}

TEST(ExportedHand, MotorsWithoutCablesTurnTheirJoints) {
  Exported exported{ReadyHand("three_finger_hand.xml")};
  ASSERT_NE(exported.model, nullptr);
  ASSERT_EQ(exported.model->nu, 8);
  exported.Settle(0.3, 2.0);
  for (const Drive& drive : exported.hand.drives()) {
    const ShaftJoint& turned = drive.shaft.joints.at(0);
    EXPECT_NEAR(exported.Angle(turned.name), turned.reference_rad + 0.3, 0.05) << turned.name;
    const int joint = mj_name2id(exported.model.get(), mjOBJ_JOINT, turned.name.c_str());
    EXPECT_EQ(exported.model->dof_armature[exported.model->jnt_dofadr[joint]],
              drive.spool.inertia_kg_m2);
  }
}

class MjcfExportOfFile : public ::testing::Test {
 protected:
  ~MjcfExportOfFile() override { std::filesystem::remove_all(folder_); }
  HandConfig Write(const std::string& xml) {
    std::filesystem::create_directories(folder_);
    std::ofstream(folder_ / "hand.xml") << xml;
    HandConfig config;
    config.model_path = (folder_ / "hand.xml").string();
    return config;
  }
  std::string Replaced(std::string xml, const std::string& from, const std::string& to) {
    const std::size_t at = xml.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    return xml.replace(at, from.size(), to);
  }

  std::filesystem::path folder_ =
      std::filesystem::temp_directory_path() / fmt::format("mjcf_export_{}", getpid());
};

// A motor may pull a tendon that has no spool; its own spring stays.
TEST_F(MjcfExportOfFile, MotorsPullTendonsWithoutASpool) {
  std::string xml = SmallHand{}.Xml();
  xml = Replaced(xml, "joint=\"joint_spool\" ctrllimited=\"true\" ctrlrange=\"-.45 .45\"",
                 "tendon=\"line\" ctrllimited=\"true\" ctrlrange=\"-50 50\"");
  xml = Replaced(xml, "name=\"joint\" tendon", "name=\"motor\" tendon");
  xml = Replaced(xml, "<spatial name=\"joint_flexor\" stiffness=\"10000\" damping=\"5\">",
                 "<spatial name=\"line\" stiffness=\"3\" damping=\"1\">");
  HandConfig config = Write(xml);
  config.motor.drum_radius_mm = {8.0};
  config.motor.rotor_inertia_kg_m2 = {3e-4};
  config.cable.stiffness_n_m = 9000.0;
  Exported exported(config);
  ASSERT_NE(exported.model, nullptr) << exported.mjcf.text;
  ASSERT_EQ(exported.model->nu, 1);
  EXPECT_NEAR(exported.model->actuator_gainprm[0], -9000.0 * 0.008, 1e-9);
  EXPECT_EQ(
      exported.model->tendon_stiffness[mj_name2id(exported.model.get(), mjOBJ_TENDON, "line")],
      3.0);
}

// Parts that count spools or motors would name what has gone.
TEST_F(MjcfExportOfFile, NothingNamesWhatHasGone) {
  const std::string xml = Replaced(SmallHand{}.Xml(), "</mujoco>",
                                   "<sensor><jointpos joint=\"joint_spool\"/></sensor>"
                                   "<keyframe><key qpos=\"0.1 0.2\"/></keyframe></mujoco>");
  Exported exported(Write(xml), "a -- b ---");
  ASSERT_NE(exported.model, nullptr);
  EXPECT_EQ(exported.model->nkey, 1);
  EXPECT_EQ(exported.model->njnt, 1);
  EXPECT_THAT(exported.mjcf.text, Not(HasSubstr("joint_spool")));
  EXPECT_THAT(exported.mjcf.text, HasSubstr("a - - b"));
}

// findings/mujoco_4_side_site_above_a_joint_lets_its_tendon_snap.sh: at 73 deg a guide is opposite
// of the side site.
TEST_F(MjcfExportOfFile, CablesThatSnapOffInNewerVersionsAreNamed) {
  const auto notes_of = [](const HandConfig& config) {
    return ExportMjcf(HandModel(config), "a test", "parts").notes;
  };
  const auto snaps = ::testing::Contains(HasSubstr("snaps off its pulley pulley"));
  EXPECT_THAT(notes_of(Write(SmallHand{}.Xml())), Not(snaps));
  EXPECT_THAT(notes_of(Write(Replaced(SmallHand{}.Xml(), "-60 60", "-100 100"))), snaps);
  EXPECT_THAT(notes_of({}), Not(::testing::Contains(HasSubstr("snaps"))));
  EXPECT_THAT(notes_of(ReadyHand("five_motor_hand.xml")),
              Not(::testing::Contains(HasSubstr("snaps"))));
}

TEST_F(MjcfExportOfFile, FilesOfTheModelComeWithIt) {
  const std::string xml =
      Replaced(SmallHand{}.Xml(), "<worldbody>",
               "<compiler meshdir=\"shapes\"/><asset><mesh file=\"a/link.stl\"/><mesh name=\"two\" "
               "file=\"b/link.stl\"/></asset><worldbody><geom type=\"mesh\" mesh=\"link\"/><geom "
               "type=\"mesh\" mesh=\"two\"/>");
  const HandConfig config = Write(xml);
  // A tetrahedron as binary STL.
  const float corners[4][3] = {{0, 0, 0}, {0.01F, 0, 0}, {0, 0.01F, 0}, {0, 0, 0.01F}};
  std::string mesh(80, ' ');
  const std::uint32_t count = 4;
  mesh.append(reinterpret_cast<const char*>(&count), sizeof count);
  for (const auto& [a, b, c] : {std::array{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}) {
    mesh.append(12, '\0');
    for (const int corner : {a, b, c}) {
      mesh.append(reinterpret_cast<const char*>(corners[corner]), sizeof corners[corner]);
    }
    mesh.append(2, '\0');
  }
  for (const char* const part : {"a", "b"}) {
    std::filesystem::create_directories(folder_ / "shapes" / part);
    std::ofstream(folder_ / "shapes" / part / "link.stl", std::ios::binary) << mesh;
  }
  const HandModel hand(config);
  const ExportedMjcf mjcf = ExportMjcf(hand, "a test", "parts");
  ASSERT_EQ(mjcf.assets.size(), 2u);
  EXPECT_EQ(mjcf.assets[0].source, folder_ / "shapes/a/link.stl");
  EXPECT_EQ(mjcf.assets[0].target, "parts/link.stl");
  EXPECT_EQ(mjcf.assets[1].target, "parts/2_link.stl");
  EXPECT_THAT(mjcf.text, HasSubstr("<mesh file=\"parts/link.stl\" name=\"link\"/>"));
  EXPECT_THAT(mjcf.text, HasSubstr("<mesh name=\"two\" file=\"parts/2_link.stl\"/>"));
  EXPECT_THAT(mjcf.text, Not(HasSubstr("meshdir")));
}

}  // namespace
}  // namespace gauntlet::sim::testing
