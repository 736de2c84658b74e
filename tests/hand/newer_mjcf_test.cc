// MJCF of newer versions: every row of the table, on a model that has the element.
#include "sim/hand/newer_mjcf.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "sim/base/error.h"
#include "sim/hand/mjcf_reader.h"
#include "sim/hand/model_files.h"
#include "sim/hand/mujoco_versions.h"
#include "tests/hand/compiled_text.h"

namespace gauntlet::sim::testing {
namespace {

using ::testing::HasSubstr;

/// Has every element whose attributes the table names.
constexpr const char* kModel = R"(<mujoco>
  <compiler autolimits="true"/>
  <option><flag/></option>
  <size/>
  <visual><global/><scale/><rgba/></visual>
  <default><pair/><tendon/></default>
  <asset>
    <mesh name="m" vertex="0 0 0 1 0 0 0 1 0 0 0 1"/>
    <texture name="t" type="2d" builtin="flat" width="2" height="2"/>
    <hfield name="h" nrow="2" ncol="2" size="1 1 1 1"/>
    <material name="a"/>
  </asset>
  <worldbody>
    <light/><camera/><site name="w"/>
    <body name="b"><freejoint/><geom name="ball" size="0.1"/></body>
    <body name="c">
      <joint name="j" range="0 60"/><geom name="link" size="0.1" pos="0.3 0 0"/><site name="s"/>
    </body>
  </worldbody>
  <contact><pair geom1="ball" geom2="link"/></contact>
  <equality><connect body1="c" anchor="0 0 0"/><weld body1="c"/></equality>
  <tendon>
    <spatial name="p"><site site="w"/><site site="s"/></spatial>
    <fixed name="f"><joint joint="j" coef="1"/></fixed>
  </tendon>
  <actuator>
    <general joint="j"/><motor joint="j"/><position joint="j"/><intvelocity joint="j" actrange="0 1"/>
  </actuator>
  <sensor><clock/></sensor>
</mujoco>
)";

class NewerMjcfTest : public ::testing::Test {
 protected:
  NewerMjcfTest() { std::filesystem::create_directories(folder_ / "parts"); }
  ~NewerMjcfTest() override { std::filesystem::remove_all(folder_); }

  std::filesystem::path Write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name) << text;
    return folder_ / name;
  }
  MjcfElement Model() const { return ReadMjcf(Write("hand.xml", kModel)); }

  const std::filesystem::path folder_ =
      std::filesystem::temp_directory_path() / ("newer_mjcf_" + std::to_string(getpid()));
};

/// The first element that the row names, or the place of one that it names as a whole.
MjcfElement* FindPlace(MjcfElement& element, const NewerMjcfRow& row) {
  const bool whole = row.attribute.empty();
  if (whole && element.name == (row.parent.empty() ? "worldbody" : row.parent)) return &element;
  for (MjcfElement& child : element.children) {
    const bool fits = row.parent.empty() || row.parent == element.name;
    if (!whole && fits && child.name == row.element) return &child;
    if (MjcfElement* const found = FindPlace(child, row)) return found;
  }
  return nullptr;
}

/// The model with what the row names.
MjcfElement With(const NewerMjcfRow& row, MjcfElement root) {
  MjcfElement* const place = FindPlace(root, row);
  if (place == nullptr) throw std::logic_error("kModel has no " + std::string(row.element));
  if (row.attribute.empty()) {
    MjcfElement& child = place->children.emplace_back();
    child.name = row.element;
    child.file = root.file;
    child.line = place->line;
  } else {
    place->Set(row.attribute, row.value.empty() ? "1" : std::string(row.value));
  }
  return root;
}

CompiledText Compiled(const MjcfElement& root) { return testing::Compiled(MjcfText(root)); }

std::string NameOf(const NewerMjcfRow& row) {
  return std::string(row.parent) + "/" + std::string(row.element) + "/" +
         std::string(row.attribute) + "=" + std::string(row.value);
}

TEST_F(NewerMjcfTest, RowsAreWhatTheEngineDoesNotKnow) {
  if (!kIsReference) GTEST_SKIP() << "a newer engine knows them";
  ASSERT_NE(Compiled(Model()), nullptr);
  for (const NewerMjcfRow& row : NewerMjcfRows()) {
    EXPECT_EQ(Compiled(With(row, Model())), nullptr) << NameOf(row);
  }
}

TEST_F(NewerMjcfTest, WhatIsDroppedIsNamedAndChangesNeitherKinematicsNorInertia) {
  const auto plain = Compiled(Model());
  ASSERT_NE(plain, nullptr);
  for (const NewerMjcfRow& row : NewerMjcfRows()) {
    if (row.action == NewerMjcf::kRefuse) continue;
    MjcfElement root = With(row, Model());
    std::vector<std::string> notes;
    DropNewerMjcf(root, notes);
    ASSERT_EQ(notes.size(), 1u) << NameOf(row);
    EXPECT_THAT(notes[0], HasSubstr("hand.xml:")) << NameOf(row);
    EXPECT_THAT(notes[0],
                HasSubstr(std::string(row.attribute.empty() ? row.element : row.attribute)))
        << NameOf(row);
    const auto model = Compiled(root);
    ASSERT_NE(model, nullptr) << NameOf(row);
    ASSERT_EQ(model->nbody, plain->nbody) << NameOf(row);
    ASSERT_EQ(model->nq, plain->nq) << NameOf(row);
    for (int i = 0; i < 3 * plain->nbody; ++i) {
      EXPECT_EQ(model->body_pos[i], plain->body_pos[i]) << NameOf(row);
      EXPECT_EQ(model->body_inertia[i], plain->body_inertia[i]) << NameOf(row);
    }
    for (int i = 0; i < 2 * plain->njnt; ++i) {
      EXPECT_EQ(model->jnt_range[i], plain->jnt_range[i]) << NameOf(row);
    }
  }
}

TEST_F(NewerMjcfTest, WhatMovesCouplesOrLoadsBodiesIsRefusedWithItsNameAndLine) {
  for (const NewerMjcfRow& row : NewerMjcfRows()) {
    if (row.action != NewerMjcf::kRefuse) continue;
    MjcfElement root = With(row, Model());
    std::vector<std::string> notes;
    try {
      DropNewerMjcf(root, notes);
      ADD_FAILURE() << NameOf(row) << " is not refused";
    } catch (const UserError& error) {
      EXPECT_THAT(error.place(), HasSubstr("hand.xml:")) << NameOf(row);
      EXPECT_THAT(error.problem(), HasSubstr("'" + std::string(row.element) + "'"));
      EXPECT_THAT(error.problem(), HasSubstr(std::string(row.attribute)));
    }
  }
}

TEST_F(NewerMjcfTest, OnlySpringsWithASlackRangeAreRefused) {
  const auto drop = [&](const char* length) {
    MjcfElement root =
        ReadMjcf(Write("hand.xml", std::string("<mujoco><tendon><fixed springlength='") + length +
                                       "'/></tendon></mujoco>"));
    std::vector<std::string> notes;
    DropNewerMjcf(root, notes);
  };
  EXPECT_NO_THROW(drop(" 0.2 "));
  try {
    drop("0 0.25");
    ADD_FAILURE() << "not refused";
  } catch (const UserError& error) {
    EXPECT_THAT(error.problem(), HasSubstr("'springlength' = '0 0.25'"));
    EXPECT_THAT(error.problem(), HasSubstr("slack range"));
  }
}

TEST_F(NewerMjcfTest, ImplicitfastBecomesImplicit) {
  MjcfElement root =
      ReadMjcf(Write("hand.xml", "<mujoco><option integrator='implicitfast'/></mujoco>"));
  std::vector<std::string> notes;
  DropNewerMjcf(root, notes);
  const auto model = Compiled(root);
  ASSERT_NE(model, nullptr);
  EXPECT_EQ(model->opt.integrator, mjINT_IMPLICIT);
  ASSERT_EQ(notes.size(), 1u);
  EXPECT_THAT(notes[0], HasSubstr("'implicit'"));
}

TEST_F(NewerMjcfTest, ElementsKeepTheirLines) {
  const MjcfElement root = Model();
  const std::string text = MjcfText(root);
  // The engine names lines of this text in its messages.
  const std::size_t at = text.find("<actuator>");
  ASSERT_NE(at, std::string::npos);
  const std::string model = kModel;
  EXPECT_EQ(std::count(text.begin(), text.begin() + at, '\n'),
            std::count(model.begin(), model.begin() + model.find("<actuator>"), '\n'));
}

TEST_F(NewerMjcfTest, IncludesAreRelativeToTheModelAndCommentsMayHoldDashes) {
  Write("parts/body.xml",
        "<mujocoinclude><!-- -- a -- comment --><include file='parts/geom.xml'/></mujocoinclude>");
  Write("parts/geom.xml", "<mujocoinclude><geom size='0.1'/></mujocoinclude>");
  const auto model = Write("model.xml",
                           "<mujoco><worldbody>\n<body><include file='parts/body.xml'/></body>\n"
                           "</worldbody></mujoco>");
  EXPECT_THAT(MjcfText(ReadModelText(model).root), HasSubstr("<body><geom size=\"0.1\"/></body>"));
  Write("parts/geom.xml", "<mujocoinclude><include file='parts/body.xml'/></mujocoinclude>");
  EXPECT_THROW(ReadModelText(model), UserError);
}

/// A hand whose body has a mesh without a file.
std::string WithMesh(const std::string& inertial, const std::string& geom) {
  return "<mujoco><default><default class='look'><geom type='mesh' mesh='m' contype='0' "
         "conaffinity='0'/></default></default><asset><mesh name='m' file='none.stl'/></asset>"
         "<worldbody><body name='b' childclass='look'>" +
         inertial + geom + "</body></worldbody></mujoco>";
}

TEST_F(NewerMjcfTest, ShapesWithoutAFileAreLeftOutWhereNoMassComesFromThem) {
  const std::string inertial = "<inertial pos='0 0 0' mass='1' diaginertia='1 1 1'/>";
  const ReadableMjcf seen = ReadModelText(Write("a.xml", WithMesh(inertial, "<geom/>")));
  EXPECT_THAT(MjcfText(seen.root), ::testing::Not(HasSubstr("<geom/>")));
  ASSERT_EQ(seen.notes.size(), 1u);
  EXPECT_THAT(seen.notes[0], HasSubstr("none.stl"));
  EXPECT_FALSE(seen.lacks_contact_shapes);
  EXPECT_TRUE(ReadModelText(Write("b.xml", WithMesh(inertial, "<geom contype='1'/>")))
                  .lacks_contact_shapes);
  EXPECT_NO_THROW(ReadModelText(Write("c.xml", WithMesh("<joint/>", "<geom density='0'/>"))));
  EXPECT_NO_THROW(ReadModelText(Write("f.xml", WithMesh("", "<geom/>"))));  // it cannot move
  EXPECT_THROW(ReadModelText(Write("d.xml", WithMesh("<joint/>", "<geom/>"))), UserError);
  EXPECT_THROW(ReadModelText(Write("e.xml", WithMesh(inertial, "<geom type='box'/>"))), UserError);
}

/// A channel of 50 mm whose section, 76 mm^2, is a U; its mass is 20.0 g. `faces` replaces the last
/// of its faces.
std::string ChannelHand(const std::string& compiler, const std::string& inertial,
                        const std::string& faces = "7 0 8 7 8 15") {
  std::string vertices;
  for (const char* const x : {"0.01", "0.06"}) {
    for (const char* const yz : {"-.007 -.007", ".007 -.007", ".007 .007", ".005 .007",
                                 ".005 -.005", "-.005 -.005", "-.005 .007", "-.007 .007"}) {
      vertices += std::string(" ") + x + " " + yz;
    }
  }
  return "<mujoco>" + compiler + "<asset><mesh name='channel' vertex='" + vertices +
         "' face='0 4 1 0 5 4 1 3 2 1 4 3 0 6 5 0 7 6 8 9 12 8 12 13 9 10 11 9 11 12 8 13 14 8 14 "
         "15 0 1 9 0 9 8 1 2 10 1 10 9 2 3 11 2 11 10 3 4 12 3 12 11 4 5 13 4 13 12 5 6 14 5 14 13 "
         "6 7 15 6 15 14 " +
         faces + "'/></asset><worldbody><body name='phalanx'><joint/>" + inertial +
         "<geom type='mesh' mesh='channel' density='5263'/></body></worldbody></mujoco>";
}

TEST_F(NewerMjcfTest, MassThatTheEngineCountsTwiceIsNamed) {
  if (!kIsReference) GTEST_SKIP() << "a newer engine counts another mass, and has another cure";
  const auto notes_of = [&](const std::string& text) {
    ReadableMjcf readable;
    const CompiledText model(LoadModel(Write("channel.xml", text), readable), &mj_deleteModel);
    return readable.notes;
  };
  const std::vector<std::string> notes = notes_of(ChannelHand("", ""));
  ASSERT_EQ(notes.size(), 1u);
  EXPECT_THAT(notes[0], HasSubstr("'phalanx' has 45.0 g"));
  EXPECT_THAT(notes[0], HasSubstr("has 20.0 g"));
  std::string unnamed = ChannelHand("", "");
  unnamed.erase(unnamed.find(" name='phalanx'"), std::string(" name='phalanx'").size());
  EXPECT_THAT(notes_of(unnamed), ::testing::ElementsAre(HasSubstr("body 1 has 45.0 g")));
  EXPECT_TRUE(notes_of(ChannelHand("<compiler exactmeshinertia='true'/>", "")).empty());
  EXPECT_TRUE(
      notes_of(ChannelHand("", "<inertial pos='0 0 0' mass='1' diaginertia='1 1 1'/>")).empty());
  EXPECT_TRUE(notes_of(ChannelHand("", "", "7 0 8")).empty());  // open: no volume is the right one
}

}  // namespace
}  // namespace gauntlet::sim::testing
