// No ready scenario asks a hand for a posture in which one digit is in another, nor does a glove
// of few sensors.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include "sim/hand/hand_kinematics.h"
#include "sim/study/scenario/scenario_reader.h"
#include "sim/study/study.h"
#include "sim/tables/name_words.h"
#include "sim/trial/joint_angles.h"
#include "tests/support/ready_scenarios.h"
#include "tests/support/source_dir.h"

namespace gauntlet::sim {
namespace {

namespace fs = std::filesystem;

/// Share of the reference in which two digits interpenetrate by more than 1 mm, looked at every
/// 10 ms.
double InterpenetrationShare(const Study& study, const Signal& reference_rad,
                             HandKinematics& hand) {
  const std::vector<std::string>& names = study.hand->joint_names();
  const auto& transmission = study.hand->transmission();
  std::vector<double> angles = hand.NeutralAngles();
  std::vector<std::ptrdiff_t> places;
  for (const HandJoint& joint : hand.joints()) {
    places.push_back(std::ranges::find(names, joint.name) - names.begin());
    EXPECT_LT(places.back(), std::ssize(names)) << joint.name;
  }
  const auto step =
      static_cast<Eigen::Index>(std::max(1.0, 0.01 * study.hand->timing().tick_rate_hz()));
  int looked = 0;
  int deep = 0;
  for (Eigen::Index tick = 0; tick < reference_rad.rows(); tick += step) {
    for (std::size_t j = 0; j < places.size(); ++j) {
      const auto place = static_cast<std::size_t>(places[j]);
      angles[j] = std::clamp(reference_rad(tick, places[j]), transmission.joint_min_rad[place],
                             transmission.joint_max_rad[place]);
    }
    hand.SetAngles(angles);
    ++looked;
    if (hand.Overlap() > 0.001) ++deep;
  }
  return static_cast<double>(deep) / looked;
}

class ReadyMotion : public testing::TestWithParam<fs::path> {};

TEST_P(ReadyMotion, KeepsDigitsApart) {
  const Study study = PrepareStudy(LoadScenario(GetParam(), {}));
  const std::string& own = study.scenario.hand.model_path;
  HandKinematics hand(
      own.empty() ? fs::path(SourceDir()) / "models" / "hand_arm.xml" : fs::path(own),
      "hand.model_path", FingerOfJointName);
  const int repetitions = static_cast<int>(study.repetitions.size());
  double most = 0.0;
  for (int i = 0; i < repetitions; ++i) {
    const auto glove = GloveOfSeed(study, study.scenario.seed + i);
    const Signal reference = ReferenceAngles(study.joint_map(), glove->true_angle_rad);
    most = std::max(most, InterpenetrationShare(study, reference, hand));
  }
  EXPECT_LE(most, 0.005);
}

INSTANTIATE_TEST_SUITE_P(Of, ReadyMotion, testing::ValuesIn(ReadyScenarios()),
                         [](const auto& test) { return test.param.stem().string(); });

TEST(Study, HoldsJointsWithoutASensorOpen) {
  const Study study =
      PrepareStudy(LoadScenario(fs::path(SourceDir()) / "scenarios/steps.yaml",
                                {"glove.channels=[index_mcp, index_pip]",
                                 "joint_map.thumb_ip={channels: [], offset_deg: 7}"}));
  const controller::JointMap joint_map = study.joint_map();
  const std::vector<std::string>& names = study.hand->joint_names();
  const auto held_deg = [&](const std::string& name) {
    const auto joint = static_cast<int>(std::ranges::find(names, name) - names.begin());
    EXPECT_FALSE(joint_map.measured(joint));
    return joint_map.offset_rad(joint) * kDegPerRad;
  };
  EXPECT_NEAR(held_deg("thumb_rotation"), 20.0, 1e-9);
  EXPECT_NEAR(held_deg("thumb_ip"), 7.0, 1e-9);
  EXPECT_NEAR(held_deg("middle_mcp"), -5.0, 1e-9);
  EXPECT_NEAR(held_deg("elbow_flexion"), 80.0, 1e-9);
}

}  // namespace
}  // namespace gauntlet::sim
