// Gloves of any number of channels drive the hand of 18 motors.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "sim/base/channels.h"
#include "sim/base/signal.h"
#include "sim/study/study.h"

namespace gauntlet::sim {
namespace {

Scenario MovedBy(const std::vector<std::string>& channels) {
  Scenario scenario;
  scenario.name = "any_glove";
  scenario.question = "Does any glove drive the hand?";
  scenario.glove.channels = channels;
  scenario.glove.motion.settings =
      RandomMotionConfig{.duration_s = 5.0, .bandwidth_hz = 0.7, .range_percent = 80.0};
  scenario.controllers = {{.name = "raw", .calibration = {}, .config = {}}};
  return scenario;
}

struct Drift {
  double largest_deg = 0.0;
  double rms_deg = 0.0;
  std::string joint;
};

/// How far the joints that no channel moves leave the posture that they are to hold.
Drift LargestDrift(const Study& study, const StudyResult& result) {
  const Signal off =
      (result.first_traces[0].hand_angle_rad - result.first_reference_rad) * kDegPerRad;
  Drift drift;
  for (Eigen::Index joint = 0; joint < off.cols(); ++joint) {
    if (std::ranges::find(study.measured_joints, static_cast<int>(joint)) !=
        study.measured_joints.end()) {
      continue;
    }
    const double largest_deg = off.col(joint).cwiseAbs().maxCoeff();
    const double rms_deg =
        std::sqrt(off.col(joint).squaredNorm() / static_cast<double>(off.rows()));
    if (largest_deg > drift.largest_deg) drift.joint = study.hand->joint_names()[joint];
    drift.largest_deg = std::max(drift.largest_deg, largest_deg);
    drift.rms_deg = std::max(drift.rms_deg, rms_deg);
  }
  return drift;
}

class AnyGlove : public testing::TestWithParam<std::vector<std::string>> {};

TEST_P(AnyGlove, MovesItsJointsAndTheOthersHoldTheirPosture) {
  const Study study = PrepareStudy(MovedBy(GetParam()));
  const StudyResult result = RunStudy(study, {});
  const TrialOutcome& outcome = result.seeds[0].controllers[0];
  ASSERT_TRUE(outcome.health.ok) << outcome.health.problem;
  EXPECT_EQ(study.measured_joint_names().size(), GetParam().size());
  for (const std::size_t row : study.rows.joints) {
    const double error_deg = outcome.scores.channels[row][MetricIndex("aligned_rmse_deg")];
    EXPECT_LT(error_deg, 5.0) << study.rows.names[row];
  }
  const Drift drift = LargestDrift(study, result);
  EXPECT_LT(drift.rms_deg, 1.0);
  // A joint whose cables pass a neighbour that moves gives way to its drag before friction lets go:
  // the dead band that the model card states is 1.4 deg.
  EXPECT_LT(drift.largest_deg, 1.4) << drift.joint;
  RecordProperty("hold", fmt::format("{:.3f} deg RMS, at most {:.3f} in {}", drift.rms_deg,
                                     drift.largest_deg, drift.joint));
}

const std::vector<std::string> kOne = {"index_mcp"};
const std::vector<std::string> kFive = {"thumb_ip", "index_pip", "middle_pip", "ring_pip",
                                        "little_pip"};
const std::vector<std::string> kFourteen = {
    "thumb_rotation", "thumb_abduction", "thumb_mcp",     "thumb_ip",     "index_mcp",
    "index_pip",      "middle_mcp",      "middle_pip",    "ring_mcp",     "ring_pip",
    "little_mcp",     "little_pip",      "finger_spread", "wrist_flexion"};

INSTANTIATE_TEST_SUITE_P(Channels, AnyGlove, testing::Values(kOne, kFive, kFourteen),
                         [](const auto& test) {
                           return std::to_string(test.param.size()) + "Channels";
                         });

}  // namespace
}  // namespace gauntlet::sim
