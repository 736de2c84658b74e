// The scenario in which trembling is felt: a bottle is lifted and held.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <string>

#include "sim/study/scenario/scenario_reader.h"
#include "sim/study/study_run.h"
#include "tests/support/source_dir.h"

namespace gauntlet::sim {
namespace {

TEST(GraspBottle, StandsUntilItIsLiftedAndAFilterCalmsTheGrip) {
  const Study study =
      PrepareStudy(LoadScenario(std::string(SourceDir()) + "/scenarios/grasp_bottle.yaml", {}));
  StudyOptions options;
  options.causes = CauseSeeds::kNone;
  options.scores = {MetricIndex("grip_force_ripple_n"), MetricIndex("object_slip_mm"),
                    MetricIndex("object_tilt_deg"), MetricIndex("grip_force_ratio"),
                    MetricIndex("lost_contact_share")};
  const StudyResult result = RunStudy(study, options);
  std::map<std::string, std::vector<double>> scores;
  for (std::size_t i = 0; i < result.controller_names.size(); ++i) {
    const std::string& name = result.controller_names[i];
    const Trace& trace = result.first_traces[i];
    ASSERT_TRUE(trace.health.ok) << trace.health.problem;
    const Eigen::Index last = trace.object_pose.rows() - 1;
    EXPECT_GT(trace.object_pose(last, 2) - trace.object_pose(0, 2), 0.08) << "not lifted: " << name;
    EXPECT_GT(trace.grip_force_n(last, 0), 10.0) << name;
    scores[name] = result.seeds[0].controllers[i].scores.summary;
    const auto of = [&](std::string_view key) { return scores[name][MetricIndex(key)]; };
    EXPECT_LT(of("object_tilt_deg"), name == "raw" ? 12.0 : 9.0) << name;
    EXPECT_LT(of("object_slip_mm"), name == "raw" ? 15.0 : 7.0) << name;
    EXPECT_GT(of("grip_force_ratio"), name == "raw" ? 0.5 : 1.5) << name;
    EXPECT_EQ(of("lost_contact_share"), 0.0) << name;
  }
  const std::size_t ripple = MetricIndex("grip_force_ripple_n");
  EXPECT_GT(scores["tuned_kalman"][ripple], 0.0);
  EXPECT_GT(scores["raw"][ripple], 1.3 * scores["tuned_kalman"][ripple]);
}

}  // namespace
}  // namespace gauntlet::sim
