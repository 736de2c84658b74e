// Tuning on recordings is judged on motion that was not fitted.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <string>

#include "sim/answers/tune/tune.h"
#include "sim/answers/tune/tune_all.h"
#include "sim/answers/tune/tune_bench.h"
#include "sim/answers/tune/tune_split.h"
#include "sim/answers/tune/tune_tables.h"
#include "sim/base/error.h"
#include "sim/settings/yaml_tree.h"
#include "tests/search/simulated_tuning.h"
#include "tests/support/program.h"

namespace gauntlet::sim {
namespace {

using testing::HasSubstr;
using testing::Not;

constexpr double kSplit_s = 22.5;  // of 45 s

class TuneOnRecordings : public testing::Test {
 protected:
  /// Movements of one joint; from `other_from_s` on of another size.
  void Record(const std::string& name, double duration_s, double other_from_s = 1e9) const {
    std::ofstream csv(folder_.path() / name);
    csv << "time_s,index_mcp\n";
    const double start = 0.1 * static_cast<double>(name.size() + 3 * name[1]);  // others differ
    for (int n = 0; n < 60.0 * duration_s; ++n) {
      const double t = n / 60.0;
      const double size_deg = t < other_from_s ? 15.0 : 3.0;
      csv << t << ','
          << 45.0 + size_deg * (std::sin(2.0 * t + start) + std::sin(3.7 * t) +
                                0.1 * std::sin(97.0 * t * (1.0 + 0.01 * std::sin(t))))
          << '\n';
    }
  }
  TunePlan PlanOf(const std::string& motion) const {
    const std::filesystem::path file = folder_.path() / "s.yaml";
    std::ofstream(file) << "question: How much smoothing?\n"
                           "glove:\n"
                           "  rate_hz: 60\n"
                           "  channels: [index_mcp]\n"
                           "  motion: {kind: recording, use: measured, "
                        << motion
                        << "}\n"
                           "controllers:\n"
                           "  smooth: {filter: {kind: moving_average, window: 9}}\n";
    TunePlan plan;
    plan.scenario = {.file = file, .text = ReadYamlText(file)};
    plan.controller = "smooth";
    plan.free = {ParseFree("filter.window=1:6:whole", "smooth")};
    plan.minimise = MetricIndex("tracking_rmse_deg");
    plan.evaluations = 4;
    plan.physics = false;
    return plan;
  }

  test::TemporaryDirectory folder_;
};

TEST_F(TuneOnRecordings, TheGainIsThatOfFreshMotion) {
  // More of them, and of several recordings: tune_coverage.
  const TuningOutcome outcome =
      SimulateTuning({.duration_s = 45.0, .fresh_s = 400.0, .scenarios = 6});
  EXPECT_GE(outcome.answered, 5);
  EXPECT_EQ(outcome.equal_parts, 0);
  EXPECT_GE(outcome.covered, outcome.answered - 1);
  EXPECT_LT(outcome.fresh_deg, -1.0);
  EXPECT_NEAR(outcome.printed_deg, outcome.fresh_deg, 0.3);
}

TEST_F(TuneOnRecordings, TheFirstHalfIsFittedAndTheSecondJudged) {
  Record("r1.csv", 45.0);
  const TunePlan plan = PlanOf("file: r1.csv");
  const TuneSplit split = SplitOf(plan, 1);
  ASSERT_EQ(split.by, TuneSplit::By::kBlocks);
  EXPECT_EQ(split.Text(TunePart::kFitted), "blocks 1 to 4");
  EXPECT_THAT(split.Text(TunePart::kHeldOut),
              HasSubstr("held-out blocks 5 to 8 of this recording"));
  ASSERT_EQ(split.divided.size(), 1u);
  EXPECT_EQ(split.divided[0].fitted.front().begin, 0);
  EXPECT_EQ(split.divided[0].fitted.back().end, split.divided[0].held_out.front().begin);
  EXPECT_NEAR(split.divided[0].fitted.back().end, 1000.0 * kSplit_s, 1000.0);
  // Motion behind the split changes what is judged, and nothing that a search sees. The reference
  // is smoothed without delay, so the last tenth of a second before the split may differ.
  const auto scores = [&](TunePart part) {
    return TuneBench(plan, TuneMetrics(plan), split, part, 1).Run({"4"}, [](double, int) {
      return true;
    });
  };
  const TunedSetting fitted = scores(TunePart::kFitted), judged = scores(TunePart::kHeldOut);
  Record("r1.csv", 45.0, kSplit_s);
  EXPECT_NEAR(scores(TunePart::kFitted).scores[0].mean / fitted.scores[0].mean, 1.0, 0.02);
  EXPECT_LT(scores(TunePart::kHeldOut).scores[0].mean, 0.5 * judged.scores[0].mean);
  EXPECT_EQ(fitted.minimised.size(), 4u);
  EXPECT_EQ(judged.minimised.size(), 4u);
}

TEST_F(TuneOnRecordings, AShortOneSaysHowMuchIsMissing) {
  Record("r1.csv", 20.0);
  try {
    Tune(PlanOf("file: r1.csv"), 1, [](double, double) { return true; });
    FAIL() << "it is too short";
  } catch (const RunError& error) {
    EXPECT_THAT(error.what(), HasSubstr("too short"));
    EXPECT_THAT(error.what(), HasSubstr("40 s are needed, and 20.0 s can be scored"));
  }
}

TEST_F(TuneOnRecordings, EnoughOfThemAreHeldOutWhole) {
  for (int i = 1; i <= 8; ++i) Record("r" + std::to_string(i) + ".csv", i <= 3 ? 22.0 : 2.0);
  TunePlan plan = PlanOf("files: \"r*.csv\"");
  const TuneSplit eight = SplitOf(plan, 1);
  EXPECT_EQ(eight.Text(TunePart::kFitted), "recordings 1 to 4");
  EXPECT_EQ(eight.Text(TunePart::kHeldOut), "held-out recordings 5 to 8 of 8");
  plan.seeds = 2;
  plan.held_out = 3;
  EXPECT_EQ(SplitOf(plan, 1).Text(TunePart::kHeldOut), "held-out recordings 3 to 5 of 8");
  const TuneSplit three = SplitOf(PlanOf("files: [r1.csv, r2.csv, r3.csv]"), 1);
  EXPECT_EQ(three.by, TuneSplit::By::kBlocks);
  EXPECT_EQ(three.BlocksOf(TunePart::kHeldOut), 6);
  EXPECT_EQ(three.Text(TunePart::kHeldOut),
            "6 held-out blocks, the second half of each of 3 recordings");
}

TEST_F(TuneOnRecordings, AFixedInputIsNotCalledHeldOut) {
  TunePlan plan = PlanOf("file: r1.csv");
  plan.scenario.text.replace(plan.scenario.text.find("{kind: recording"),
                             std::string("{kind: recording, use: measured, file: r1.csv}").size(),
                             "{kind: hold, duration_s: 1}");
  plan.scenario.overrides = {
      "glove.noise=none",
      "glove.sensor={gain_deviation_percent: 0, offset_deviation_percent: 0, "
      "curvature_deviation_percent: 0, cross_talk_percent: 0, hysteresis_deg: 0}"};
  const TuneSplit split = SplitOf(plan, 1);
  EXPECT_TRUE(split.is_fixed);
  EXPECT_THAT(SplitText(split), Not(HasSubstr("held-out")));
}

/// Kinds with an answer on the blocks of one recording, the chosen one first.
std::vector<TunedKind> KindsOnBlocks(const std::vector<std::string>& names) {
  std::vector<TunedKind> kinds;
  for (const std::string& name : names) {
    TunedKind& kind = kinds.emplace_back();
    kind.kind = name;
    kind.result.split.by = TuneSplit::By::kBlocks;
    kind.result.split.recordings = 1;
    kind.result.metrics = {MetricIndex("delay_ms")};
    kind.result.verdict.scores = {{.mean = 7.0}};
    kind.to_best.judgement = Judgement::kUndecided;
  }
  return kinds;
}

TEST(TuneAllOnRecordings, ComparesNoKindWithItselfAndAdvisesNoSeeds) {
  TunePlan plan;
  plan.minimise = MetricIndex("delay_ms");
  std::vector<TunedKind> kinds = KindsOnBlocks({"savitzky_golay", "none"});
  EXPECT_EQ(VerdictOf(plan, kinds).Text(),
            "Chosen on the fitted blocks: savitzky_golay: delay 7.00 ms. No recommendation, as it "
            "is undecided against none. A longer recording, or several, can decide it.");
  kinds[1].to_best.judgement = Judgement::kBetter;
  EXPECT_EQ(VerdictOf(plan, kinds).recommended, "");
  EXPECT_THAT(VerdictOf(plan, kinds).Text(), HasSubstr("it is worse than none"));
  kinds[1].to_best.judgement = Judgement::kWorse;
  EXPECT_EQ(VerdictOf(plan, kinds).recommended, "savitzky_golay");
}

TEST(TuneAllOnRecordings, NamesTheNearestSettingOfAllKinds) {
  TunePlan plan;
  plan.controller = "raw";
  plan.minimise = MetricIndex("delay_ms");
  plan.constraints = {ParseConstraint("jitter_rms_deg<=0.1", "")};
  std::vector<TunedKind> kinds = KindsOnBlocks({"none", "one_euro"});
  for (TunedKind& kind : kinds) {
    kind.plan = plan;
    kind.result.metrics = {MetricIndex("delay_ms"), MetricIndex("jitter_rms_deg")};
    kind.result.problem = "no setting keeps the bounds";
    kind.result.nearest = 0;
    kind.result.tried = {{.scores = {{.mean = 7.0}, {.mean = 0.563}}}};
  }
  kinds[1].plan.free = {ParseFree("filter.beta=0:1", "raw")};
  kinds[1].result.tried = {{.values = {"0.5"}, .scores = {{.mean = 7.0}, {.mean = 0.119}}}};
  EXPECT_EQ(VerdictOf(plan, kinds).Text(),
            "No kind of filter keeps jitter_rms_deg<=0.1; closest is one_euro (beta=0.5) with "
            "jitter_rms_deg 0.119.");
}

}  // namespace
}  // namespace gauntlet::sim
