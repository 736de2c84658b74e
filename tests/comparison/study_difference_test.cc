// What differs between made-up output folders whose difference is known.
#include "sim/answers/compare/study_difference.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "sim/base/error.h"
#include "sim/base/json.h"
#include "sim/score/score.h"

namespace gauntlet::sim {
namespace {

/// A folder whose scores are all `base` plus an effect of the seed, which is larger.
StudyFolder Folder(double base, int first_seed, int seeds) {
  StudyFolder folder;
  folder.name = "folder";
  folder.scenario.question = "q";
  folder.scenario.controllers = {{.name = "raw", .config = {}}};
  folder.scores.seeds.resize(static_cast<std::size_t>(seeds));
  std::iota(folder.scores.seeds.begin(), folder.scores.seeds.end(), first_seed);
  folder.scores.controllers = {"raw"};
  folder.scores.channels = {"index_mcp"};
  std::vector<double> values;
  for (const int seed : folder.scores.seeds) values.push_back(base + 0.8 * std::sin(1.7 * seed));
  folder.scores.has_metric.assign(Metrics().size(), true);
  folder.scores.summary = {{Metrics().size(), values}};
  return folder;
}

const ScoreDifference& Score(const StudyDifference& difference, std::string_view key) {
  return *std::ranges::find(difference.scores, MetricIndex(key), &ScoreDifference::metric);
}

TEST(CompareStudies, AFolderIsTheSameAsItself) {
  const StudyFolder folder = Folder(5.0, 1, 8);
  const StudyDifference difference = CompareStudies(folder, folder);
  EXPECT_TRUE(difference.Same());
  EXPECT_EQ(difference.scores.size(), Metrics().size());
  EXPECT_EQ(difference.ChangedScores(), 0u);
}

TEST(CompareStudies, PassesOverAMetricThatOneOfThemDoesNotKnow) {
  const StudyFolder a = Folder(5.0, 1, 8);
  StudyFolder older = Folder(5.0, 1, 8);
  const std::size_t delay = MetricIndex("delay_ms");
  older.scores.has_metric[delay] = false;
  older.scores.summary[0][delay].assign(8, kNaN);
  const StudyDifference difference = CompareStudies(a, older);
  EXPECT_TRUE(difference.Same());
  EXPECT_EQ(difference.scores.size(), Metrics().size() - 1);
  EXPECT_EQ(difference.metrics_only_in_a, std::vector<std::string>{"delay_ms"});
  EXPECT_TRUE(difference.metrics_only_in_b.empty());
}

TEST(CompareStudies, RefusesScoresOfTwoEngines) {
  StudyFolder a = Folder(5.0, 1, 8);
  StudyFolder b = Folder(5.0, 1, 8);
  a.name = "out/a";
  b.name = "out/b";
  a.scenario.made_with.mujoco_version = "2.2.2";
  EXPECT_TRUE(CompareStudies(a, b).Same()) << "written by hand: nobody says which engine";
  b.scenario.made_with.mujoco_version = "4.0.0";
  try {
    CompareStudies(a, b);
    FAIL();
  } catch (const UserError& error) {
    EXPECT_STREQ(error.what(),
                 "out/b: was computed with MuJoCo 4.0.0, out/a with 2.2.2: scores of two engines "
                 "are not compared");
  }
}

TEST(CompareStudies, PairsSeeWhatTheScatterOfSeedsHides) {
  const StudyFolder a = Folder(5.0, 1, 8);
  StudyFolder b = Folder(5.1, 1, 8);
  for (auto& values : b.scores.summary[0]) values[3] += 0.01;  // a scatter of the difference
  const StudyDifference paired = CompareStudies(a, b);
  EXPECT_EQ(paired.method, DifferenceMethod::kPaired);
  EXPECT_EQ(Score(paired, "tracking_rmse_deg").change, ScoreChange::kWorse);
  EXPECT_EQ(Score(paired, "sparc").change, ScoreChange::kBetter);  // more of it is better
  EXPECT_NEAR(Score(paired, "delay_ms").difference.mean, 0.10125, 1e-9);
  EXPECT_GT(Score(paired, "delay_ms").difference.low, 0.09);
  EXPECT_FALSE(paired.Same());

  const StudyDifference unpaired = CompareStudies(a, Folder(5.1, 101, 8));
  EXPECT_EQ(unpaired.method, DifferenceMethod::kUnpaired);
  EXPECT_EQ(Score(unpaired, "tracking_rmse_deg").change, ScoreChange::kNone);
  EXPECT_EQ(CompareStudies(a, Folder(9.0, 101, 8)).ChangedScores(), Metrics().size());
}

TEST(CompareStudies, PairsTheSeedsWhateverTheirOrder) {
  const StudyFolder a = Folder(5.0, 1, 8);
  StudyFolder b = a;
  std::ranges::reverse(b.scores.seeds);
  for (auto& values : b.scores.summary[0]) std::ranges::reverse(values);
  EXPECT_TRUE(CompareStudies(a, b).Same());
}

TEST(CompareStudies, ComparesTheSeedsThatBothHave) {
  const StudyFolder a = Folder(5.0, 1, 8);
  const StudyDifference more = CompareStudies(a, Folder(5.0, 3, 20));
  EXPECT_EQ(more.method, DifferenceMethod::kPaired);
  EXPECT_EQ(more.common_seeds, (std::vector<int>{3, 4, 5, 6, 7, 8}));
  EXPECT_TRUE(more.Same());
  EXPECT_EQ(CompareStudies(a, Folder(5.1, 3, 20)).ChangedScores(), Metrics().size());

  const StudyDifference run = CompareStudies(Folder(5.0, 3, 1), a);
  EXPECT_EQ(run.method, DifferenceMethod::kPlain);
  EXPECT_EQ(run.common_seeds, std::vector<int>{3});
  EXPECT_TRUE(run.Same());
  EXPECT_EQ(CompareStudies(Folder(5.0, 9, 1), a).common_seeds.size(), 0u);
}

TEST(CompareStudies, WithOneSeedEveryDifferenceButRoundingCounts) {
  const StudyFolder a = Folder(5.0, 1, 1);
  StudyFolder b = a;
  b.scores.summary[0][0][0] *= 1.0 + 1e-12;
  EXPECT_TRUE(CompareStudies(a, b).Same());
  b.scores.summary[0][0][0] *= 1.0 + 1e-8;
  const StudyDifference difference = CompareStudies(a, b);
  EXPECT_EQ(difference.method, DifferenceMethod::kPlain);
  EXPECT_EQ(difference.ChangedScores(), 1u);
  EXPECT_EQ(Score(difference, "tracking_rmse_deg").change, ScoreChange::kWorse);
  EXPECT_TRUE(std::isnan(Score(difference, "tracking_rmse_deg").difference.low));
}

TEST(CompareStudies, AScoreThatOnlyOneHasDiffers) {
  StudyFolder a = Folder(5.0, 1, 4);
  StudyFolder b = a;
  a.scores.summary[0][MetricIndex("sparc")].assign(4, kNaN);
  b.scores.summary[0][MetricIndex("sparc")].assign(4, kNaN);
  EXPECT_TRUE(CompareStudies(a, b).Same());
  b.scores.summary[0][MetricIndex("ldlj")].assign(4, kNaN);
  EXPECT_EQ(Score(CompareStudies(a, b), "ldlj").change, ScoreChange::kOnlyInA);
  EXPECT_EQ(Score(CompareStudies(b, a), "ldlj").change, ScoreChange::kOnlyInB);
}

TEST(CompareStudies, SettingsAreComparedOneByOneAndVersionsDoNotCount) {
  const StudyFolder a = Folder(5.0, 1, 4);
  StudyFolder b = a;
  b.scenario.made_with.model_hash = "abc";
  StudyDifference difference = CompareStudies(a, b);
  EXPECT_TRUE(difference.Same());
  ASSERT_EQ(difference.versions.size(), 1u);
  EXPECT_EQ(difference.versions[0].key, "made_with.model_hash");

  b.scenario.event.delay_ms = a.scenario.event.delay_ms + 1.5;
  b.scenario.glove.faults.emplace_back();
  difference = CompareStudies(a, b);
  EXPECT_FALSE(difference.Same());
  ASSERT_GE(difference.settings.size(), 2u);
  const auto delay =
      std::ranges::find(difference.settings, "event.delay_ms", &SettingDifference::key);
  ASSERT_NE(delay, difference.settings.end());
  EXPECT_NE(delay->a, delay->b);
  const auto fault =
      std::ranges::find(difference.settings, "glove.faults.0.kind", &SettingDifference::key);
  ASSERT_NE(fault, difference.settings.end());
  EXPECT_FALSE(fault->a.has_value());
  EXPECT_TRUE(fault->b.has_value());
}

TEST(CompareStudies, ControllersAndChannelsOfOneOnlyAreNamed) {
  const StudyFolder a = Folder(5.0, 1, 4);
  StudyFolder b = a;
  b.scenario.controllers.push_back({.name = "new", .config = {}});
  b.scores.controllers.push_back("new");
  b.scores.summary.push_back(b.scores.summary[0]);
  b.scores.channels = {"index_mcp", "index_pip"};
  const StudyDifference difference = CompareStudies(a, b);
  EXPECT_EQ(difference.controllers_only_in_b, std::vector<std::string>{"new"});
  EXPECT_EQ(difference.channels_only_in_b, std::vector<std::string>{"index_pip"});
  EXPECT_TRUE(difference.settings.empty());  // not all those of the new controller
  EXPECT_EQ(difference.scores.size(), Metrics().size());
  EXPECT_FALSE(difference.Same());
  EXPECT_FALSE(CompareStudies(b, a).Same());
}

TEST(CompareStudies, MeansOverOtherJointsAreShownAndNotJudged) {
  const StudyFolder a = Folder(5.0, 1, 8);
  StudyFolder b = Folder(9.0, 1, 8);
  EXPECT_EQ(Score(CompareStudies(a, b), "tracking_rmse_deg").change, ScoreChange::kWorse);
  b.scores.channels = {"index_mcp", "index_pip"};
  const StudyDifference difference = CompareStudies(a, b);
  EXPECT_EQ(Score(difference, "tracking_rmse_deg").change, ScoreChange::kOtherJoints);
  EXPECT_NEAR(Score(difference, "tracking_rmse_deg").difference.mean, 4.0, 1e-9);
}

TEST(StudyDifferenceJson, HoldsEveryScore) {
  const StudyFolder a = Folder(5.0, 1, 4);
  StudyFolder b = Folder(4.0, 1, 4);
  b.scenario.seed = 2;
  const auto json = Json::parse(StudyDifferenceJson(a, b, CompareStudies(a, b)).dump());
  EXPECT_EQ(json["same"], false);
  EXPECT_EQ(json["method"], "paired");
  EXPECT_EQ(json["settings"][0], Json::parse(R"({"key": "seed", "a": "1", "b": "2"})"));
  ASSERT_EQ(json["scores"].size(), Metrics().size());
  EXPECT_EQ(json["scores"][0]["metric"], Metrics()[0].key);
  EXPECT_EQ(json["scores"][0]["change"], "better");
  EXPECT_NEAR(json["scores"][0]["difference"]["mean"].get<double>(), -1.0, 1e-12);
}

}  // namespace
}  // namespace gauntlet::sim
