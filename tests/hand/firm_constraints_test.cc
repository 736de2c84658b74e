#include "sim/hand/firm_constraints.h"

#include <gmock/gmock.h>
#include <mujoco/mujoco.h>

#include <cmath>
#include <string>
#include <vector>

#include "tests/hand/compiled_text.h"

namespace gauntlet::sim::testing {
namespace {

constexpr double kGravity_m_s2 = 10.0;

/// A point mass of 0.1 kg on a rod of 0.1 m, level at 0: gravity pulls with 0.1 N m.
std::string RodXml(const std::string& joint, const std::string& equality) {
  return R"(
<mujoco>
  <option timestep="0.001" gravity="0 0 -10"/>
  <worldbody>
    <body name="rod">
      <joint axis="0 1 0" )" +
         joint + R"(/>
      <geom type="sphere" size=".001" pos=".1 0 0" mass=".1"/>
    </body>
  </worldbody>
  <equality>)" +
         equality + R"(</equality>
</mujoco>)";
}

/// Angle after 5 s from rest.
double AngleAfter(const CompiledText& model) {
  mjData* const data = mj_makeData(model.get());
  for (int step = 0; step < 5000; ++step) mj_step(model.get(), data);
  const double angle_rad = data->qpos[0];
  mj_deleteData(data);
  return angle_rad;
}

TEST(FirmConstraints, DryFrictionHoldsWhatItIsLargerThan) {
  const CompiledText model = Compiled(RodXml(R"(frictionloss="0.12")", ""));
  EXPECT_GT(AngleAfter(model), 0.1);  // of the engine: it creeps
  FirmConstraints(*model, {});
  EXPECT_LT(std::abs(AngleAfter(model)), 0.001);
  const CompiledText weak = Compiled(RodXml(R"(frictionloss="0.08")", ""));
  FirmConstraints(*weak, {});
  EXPECT_GT(AngleAfter(weak), 0.5);
}

TEST(FirmConstraints, LinkageDoesNotOpen) {
  const std::string linkage = R"(<connect body1="rod" anchor="0.1 0 0" )";
  const CompiledText model = Compiled(RodXml("", linkage + "/>"));
  EXPECT_GT(AngleAfter(model), 1e-3);
  FirmConstraints(*model, {});
  EXPECT_LT(std::abs(AngleAfter(model)), 1e-5);
}

TEST(FirmConstraints, SettingsOfTheFileStay) {
  const CompiledText model =
      Compiled(RodXml(R"(frictionloss="0.12" solreffriction="0.05 1" solimpfriction="0.8 0.9")",
                      R"(<connect body1="rod" anchor="0.1 0 0" solref="0.03 1"/>)"));
  FirmConstraints(*model, {});
  EXPECT_EQ(model->dof_solref[0], 0.05);
  EXPECT_EQ(model->dof_solimp[0], 0.8);
  EXPECT_EQ(model->eq_solref[0], 0.03);
  EXPECT_EQ(model->eq_solimp[0], 0.9999);  // the file does not set it
}

TEST(FirmConstraints, SpoolsStay) {
  const CompiledText model = Compiled(RodXml(R"(frictionloss="0.12")", ""));
  std::vector<Drive> drives(1);
  drives[0].spool_dof = 0;
  FirmConstraints(*model, drives);
  EXPECT_EQ(model->dof_solref[0], 0.02);
}

}  // namespace
}  // namespace gauntlet::sim::testing
