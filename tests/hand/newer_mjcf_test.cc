// MJCF of newer versions: every row of the table, on a model that has the element.
#include "sim/hand/newer_mjcf.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>
#include <unistd.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "sim/base/error.h"
#include "sim/hand/mjcf_reader.h"

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

std::unique_ptr<mjModel, void (*)(mjModel*)> Compiled(const MjcfElement& root) {
  const std::string text = MjcfText(root);
  const auto files = std::make_unique<mjVFS>();
  mj_defaultVFS(files.get());
  mj_makeEmptyFileVFS(files.get(), "model.xml", static_cast<int>(text.size()));
  std::memcpy(files->filedata[0], text.data(), text.size());
  char message[500] = "";
  mjModel* const model = mj_loadXML("model.xml", files.get(), message, sizeof message);
  mj_deleteVFS(files.get());
  return {model, &mj_deleteModel};
}

std::string NameOf(const NewerMjcfRow& row) {
  return std::string(row.parent) + "/" + std::string(row.element) + "/" +
         std::string(row.attribute) + "=" + std::string(row.value);
}

TEST_F(NewerMjcfTest, RowsAreWhatTheEngineDoesNotKnow) {
  ASSERT_NE(Compiled(Model()), nullptr);
  for (const NewerMjcfRow& row : NewerMjcfRows()) {
    EXPECT_EQ(Compiled(With(row, Model())), nullptr) << NameOf(row);
  }
}

TEST_F(NewerMjcfTest, WhatIsDroppedIsNamedAndChangesNeitherKinematicsNorInertia) {
  const auto plain = Compiled(Model());
  ASSERT_NE(plain, nullptr);
  for (const NewerMjcfRow& row : NewerMjcfRows()) {
    if (row.action != NewerMjcf::kDrop) continue;
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
  EXPECT_THAT(ReadModelText(model).text, HasSubstr("<body><geom size=\"0.1\"/></body>"));
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
  EXPECT_THAT(seen.text, ::testing::Not(HasSubstr("<geom/>")));
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

}  // namespace
}  // namespace gauntlet::sim::testing
