// The scenario in which trembling is felt: a bottle is lifted and held.
#include <gtest/gtest.h>

#include "sim/scenario/scenario_reader.h"
#include "sim/study/study_run.h"
#include "tests/support/source_dir.h"

namespace gauntlet::sim {
namespace {

TEST(GraspBottle, IsLiftedAndAFilterCalmsTheGrip) {
  Scenario scenario = LoadScenario(std::string(SourceDir()) + "/scenarios/grasp_bottle.yaml", {});
  std::erase_if(scenario.controllers, [](const NamedController& controller) {
    return controller.name != "raw" && controller.name != "tuned_kalman";
  });
  ASSERT_EQ(scenario.controllers.size(), 2u);
  const StudyResult result = RunStudy(PrepareStudy(std::move(scenario)), StudyOptions{});
  double ripple_n[2];
  for (std::size_t i = 0; i < 2; ++i) {
    const Trace& trace = result.first_traces[i];
    ASSERT_TRUE(trace.health.ok) << trace.health.problem;
    const Eigen::Index last = trace.object_pose.rows() - 1;
    EXPECT_GT(trace.object_pose(last, 2) - trace.object_pose(0, 2), 0.08) << "not lifted";
    EXPECT_GT(trace.grip_force_n(last, 0), 10.0);
    const Scores& scores = result.seeds[0].controllers[i].scores;
    ripple_n[i] = scores.summary[MetricIndex("grip_force_ripple_n")];
  }
  EXPECT_GT(ripple_n[1], 0.0);
  EXPECT_GT(ripple_n[0], 3.0 * ripple_n[1]);
}

}  // namespace
}  // namespace gauntlet::sim
