// Jitter of the fingers, and how much of it an arm makes.
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <string>
#include <vector>

#include "controller/filters/paper_noise.h"
#include "sim/study/scenario/scenario_reader.h"
#include "sim/study/study_run.h"
#include "tests/support/program.h"
#include "tests/support/source_dir.h"

namespace gauntlet::sim {
namespace {

class ArmJitterTest : public testing::Test {
 protected:
  /// Scores of a hand that follows a random motion without a filter.
  std::vector<double> Scored(const std::vector<std::string>& overrides) const {
    const auto file = folder_.path() / "scenario.yaml";
    std::ofstream(file) << "question: q\nglove: {motion: {kind: random, duration_s: 4}}\n"
                           "controllers:\n  raw: {filter: none}\n";
    const Study study = PrepareStudy(LoadScenario(file, overrides));
    const StudyResult result = RunStudy(study, {.jobs = 2, .causes = CauseSeeds::kFirst});
    std::vector<double> scores = result.seeds[0].controllers[0].scores.summary;
    joints_ = study.measured_joint_names;
    first_deg_ = kDegPerRad * result.first_reference_rad.row(0);
    return scores;
  }
  static double Of(const std::vector<double>& scores, std::string_view metric) {
    return scores[MetricIndex(metric)];
  }
  /// Noise in these channels alone, as large as the paper's.
  static std::string NoiseOf(int first, int end) {
    std::vector<double> variance = controller::PaperMeasurementVariance();
    for (int c = 0; c < std::ssize(variance); ++c) {
      if (c < first || c >= end) variance[static_cast<std::size_t>(c)] = 0.0;
    }
    return fmt::format("glove.noise.variance_counts2=[{}]", fmt::join(variance, ", "));
  }

  test::TemporaryDirectory folder_;
  mutable std::vector<std::string> joints_;
  mutable Eigen::RowVectorXd first_deg_;
};

constexpr int kFirstOfArm = 16;  // elbow and shoulder are the last two channels
constexpr int kChannels = 18;

// 0.077 and 0.049 deg. A stiff arm made 0.28 of 0.28 deg, and moved the palm with 21 m/s2.
TEST_F(ArmJitterTest, TheArmsNoiseMakesAsMuchOfTheFingersJitterAsTheirOwnAndNotAllOfIt) {
  const std::vector<double> arm = Scored({NoiseOf(kFirstOfArm, kChannels)});
  const std::vector<double> hand = Scored({NoiseOf(0, kFirstOfArm)});
  EXPECT_LT(Of(arm, "finger_jitter_rms_deg"), 2.0 * Of(hand, "finger_jitter_rms_deg"));
  EXPECT_LT(Of(arm, "palm_acceleration_m_s2"), 8.0);
  EXPECT_GT(Of(arm, "arm_jitter_rms_deg"), 3.0 * Of(hand, "arm_jitter_rms_deg"));
}

TEST_F(ArmJitterTest, TheArmsShareIsWhatIsGoneWhereASettingHoldsIt) {
  const std::vector<double> moving = Scored({});
  std::vector<std::string> held;
  for (const char* joint : {"elbow_flexion", "shoulder_flexion"}) {
    const auto place = std::ranges::find(joints_, joint) - joints_.begin();
    held.push_back(fmt::format("joint_map.{}={{channels: [], offset_deg: {:.17g}}}", joint,
                               first_deg_[place]));
  }
  const double at_rest_deg = Of(Scored(held), "finger_jitter_rms_deg");
  EXPECT_NEAR(Of(moving, "arm_share_of_finger_jitter"),
              1.0 - at_rest_deg / Of(moving, "finger_jitter_rms_deg"), 1e-6);
  EXPECT_GT(Of(moving, "arm_share_of_finger_jitter"), 0.1);
}

TEST_F(ArmJitterTest, AHandWithoutAnArmHasNone) {
  const std::vector<double> scores =
      Scored({"hand.model_path=" + std::string(SourceDir()) + "/models/three_finger_hand.xml"});
  for (const char* metric : {"arm_jitter_rms_deg", "arm_share_of_finger_jitter"}) {
    EXPECT_TRUE(std::isnan(Of(scores, metric))) << metric;
  }
}

}  // namespace
}  // namespace gauntlet::sim
