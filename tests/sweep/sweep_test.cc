// A sweep holds what comparisons of its cells would, whatever the schedule and whatever stopped it.
#include <SQLiteCpp/SQLiteCpp.h>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <set>

#include "sim/answers/sweep/response.h"
#include "sim/answers/sweep/sobol.h"
#include "sim/answers/sweep/sweep_result.h"
#include "sim/answers/sweep/sweep_tables.h"
#include "sim/base/error.h"
#include "sim/study/scenario/scenario_reader.h"
#include "tests/support/program.h"
#include "tests/support/source_dir.h"

namespace gauntlet::sim {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

constexpr const char* kScenario = R"(
question: Does a sweep work?
glove:
  motion: {kind: random, duration_s: 0.3, bandwidth_hz: 2}
score: {noise_free_twin: false}
controllers:
  raw: {filter: none}
  mean: {filter: {kind: moving_average, window: 5}}
)";

constexpr const char* kSweep = R"(
question: Which mean is best?
scenario: base.yaml
controllers: [mean, raw]
seeds: 3
physics: false
axes:
  - {key: controllers.mean.filter.window, values: [1, 5, 0, 9]}
  - {key: glove.rate_hz, low: 500, high: 1000, count: 2}
scores: [tracking_rmse_deg]
)";

class SweepTest : public testing::Test {
 protected:
  SweepTest() {
    Write("base.yaml", kScenario);
    Write("sweep.yaml", kSweep);
  }

  void Write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_.path() / name) << text;
  }
  fs::path Path(const std::string& name) const { return folder_.path() / name; }
  SweepPlan Plan(const std::string& text) const {
    Write("other.yaml", text);
    return LoadSweepPlan(Path("other.yaml"));
  }
  std::string Problem(const std::string& text) const {
    try {
      Plan(text);
    } catch (const UserError& error) {
      return error.what();
    }
    return "";
  }
  /// kSweep with one line in place of another.
  static std::string With(const std::string& line, const std::string& other) {
    std::string text = kSweep;
    const std::size_t at = text.find(line);
    return text.replace(at, line.size(), other);
  }
  /// cells.csv of a sweep in this database, after running what is missing.
  std::string Run(const SweepPlan& plan, const std::string& database, int jobs = 1,
                  const CellRange* cells = nullptr) const {
    SweepDatabase kept(Path(database), HashOfSweep(plan), plan.metrics);
    const CellRange all = ShardOf(plan, 1, 1);
    RunSweep(plan, kept, {.jobs = jobs, .cells = cells == nullptr ? all : *cells});
    return Csv(plan, kept);
  }
  static std::string Csv(const SweepPlan& plan, SweepDatabase& database) {
    std::string csv;
    WriteCellsCsv(plan, database, ShardOf(plan, 1, 1),
                  [&csv](std::string_view text) { csv += text; });
    return csv;
  }

  test::TemporaryDirectory folder_;
};

TEST(Sobol, PutsOnePointIntoEachEqualPartOfEveryCoordinate) {
  for (int dimension = 0; dimension < kSobolDimensions; ++dimension) {
    for (const int points : {2, 16, 256}) {
      std::set<int> parts;
      for (int i = 0; i < points; ++i) {
        parts.insert(
            static_cast<int>(points * SobolPoint(static_cast<std::uint32_t>(i), dimension)));
      }
      EXPECT_EQ(std::ssize(parts), points) << dimension;
      EXPECT_EQ(*parts.rbegin(), points - 1);
    }
  }
}

TEST(Sobol, FillsSquaresOfTheFirstTwoCoordinatesEvenly) {
  // A (0, 2)-sequence: of 2^k points one in each box of area 2^-k.
  for (const int columns : {1, 4, 16, 64}) {
    std::set<int> boxes;
    for (int i = 0; i < 64; ++i) {
      const auto index = static_cast<std::uint32_t>(i);
      boxes.insert(static_cast<int>(columns * SobolPoint(index, 0)) * 64 +
                   static_cast<int>(64 / columns * SobolPoint(index, 1)));
    }
    EXPECT_EQ(boxes.size(), 64u);
  }
}

TEST_F(SweepTest, NumbersCellsSoThatNeighboursShareTheirGlove) {
  const SweepPlan plan = LoadSweepPlan(Path("sweep.yaml"));
  ASSERT_EQ(plan.cell_count(), 8);
  EXPECT_THAT(plan.ValuesOf(0), ElementsAre("1", "500"));
  EXPECT_THAT(plan.ValuesOf(1), ElementsAre("5", "500"));
  EXPECT_THAT(plan.ValuesOf(3), ElementsAre("9", "500"));
  EXPECT_THAT(plan.ValuesOf(4), ElementsAre("1", "1000"));
}

TEST_F(SweepTest, SpacesRangesAsAsked) {
  const SweepPlan log =
      Plan(With("low: 500, high: 1000, count: 2", "low: 10, high: 1000, count: 3, spacing: log"));
  EXPECT_EQ(log.ValuesOf(4)[1], "100");
  const SweepPlan whole =
      Plan(With("low: 500, high: 1000, count: 2", "low: 500, high: 1001, count: 3, whole: true"));
  EXPECT_EQ(whole.ValuesOf(4)[1], "751");
  std::string text = With("low: 500, high: 1000, count: 2", "low: 500, high: 1000");
  text.insert(text.find("axes:"), "design: random\ncells: 40\n");
  const SweepPlan random = Plan(text);
  EXPECT_EQ(random.cell_count(), 40);
  std::set<std::string> rates;
  for (int cell = 0; cell < 40; ++cell) {
    const std::string rate = random.ValuesOf(cell)[1];
    EXPECT_GE(std::stod(rate), 500.0);
    EXPECT_LE(std::stod(rate), 1000.0);
    rates.insert(rate);
  }
  EXPECT_EQ(rates.size(), 40u);
}

TEST_F(SweepTest, RefusesWhatMakesNoSenseAndSaysWhere) {
  EXPECT_THAT(Problem(With("question:", "questoin:")),
              AllOf(HasSubstr("other.yaml:2:1: questoin: unknown key"), HasSubstr("question")));
  EXPECT_THAT(Problem(With("values: [1, 5, 0, 9]", "values: []")), HasSubstr("is empty"));
  EXPECT_THAT(Problem(With("low: 500, high: 1000, count: 2", "low: 500, high: 400, count: 2")),
              HasSubstr("must be above low, which is 500"));
  EXPECT_THAT(Problem(With("count: 2", "count: 2, spacing: log, values: [1]")),
              HasSubstr("can have no range"));
  EXPECT_THAT(Problem(With("filter.window", "filter.windoww")),
              AllOf(HasSubstr("other.yaml:8:11: controllers.mean.filter.windoww"),
                    HasSubstr("unknown key")));
  EXPECT_THAT(Problem(With("controllers: [mean, raw]", "controllers: [raw]")),
              HasSubstr("not among controllers"));
  EXPECT_THAT(Problem(With("controllers: [mean, raw]", "controllers: [mean, rwa]")),
              AllOf(HasSubstr("rwa: unknown controller"), HasSubstr("raw")));
  EXPECT_THAT(Problem(With("scores: [tracking_rmse_deg]", "subject_to: [jiter_rms_deg<=1]")),
              AllOf(HasSubstr("other.yaml:10:14: subject_to[0]"), HasSubstr("jitter_rms_deg")));
  EXPECT_THAT(Problem(With("scores: [tracking_rmse_deg]", "subject_to: [jitter_rms_deg<1]")),
              HasSubstr("must be SCORE<=NUMBER"));
  EXPECT_THAT(Problem(With("scores: [tracking_rmse_deg]", "scores: [command_reversals_per_s]")),
              HasSubstr("there is none without a hand"));
  EXPECT_THAT(Problem(With("glove.rate_hz", "seed")), HasSubstr("is the same for all settings"));
  EXPECT_THAT(Problem(With("physics: false", "design: sobol")), HasSubstr("count: is for a grid"));
  EXPECT_THAT(Problem(With("physics: false", "cells: 9")),
              HasSubstr("a grid has all its settings"));
}

TEST_F(SweepTest, ReadsFilesOfEarlierVersionsThatAskForAllSeeds) {
  EXPECT_EQ(Problem(With("physics: false", "all_seeds: true")), "");
  EXPECT_THAT(Problem("- all_seeds"), HasSubstr("other.yaml:1:1"));
}

TEST_F(SweepTest, KeepsACellThatCannotBeBuiltWithItsReason) {
  const SweepPlan plan = LoadSweepPlan(Path("sweep.yaml"));
  SweepDatabase database(Path("a.db"), HashOfSweep(plan), plan.metrics);
  RunSweep(plan, database, {.cells = ShardOf(plan, 1, 1)});
  const SweepSummary summary = SummariseSweep(plan, database, ShardOf(plan, 1, 1));
  EXPECT_EQ(summary.not_built, 2);        // window 0 at either rate
  EXPECT_EQ(summary.results, 2 * 2 * 3);  // two controllers
  EXPECT_THAT(summary.first_problem, AllOf(HasSubstr("setting 2"), HasSubstr("window")));
  ASSERT_FALSE(summary.best.empty());
}

TEST_F(SweepTest, GivesTheSameBytesForAnyScheduleAndAfterAnyStop) {
  const SweepPlan plan = LoadSweepPlan(Path("sweep.yaml"));
  const std::string whole = Run(plan, "whole.db");
  EXPECT_EQ(std::ranges::count(whole, '\n'), 1 + 2 * (1 + 3 * 2));
  EXPECT_EQ(Run(plan, "two.db", 2), whole);
  {
    SweepDatabase stopped(Path("stopped.db"), HashOfSweep(plan), plan.metrics);
    int left = 7;
    EXPECT_THROW(RunSweep(plan, stopped,
                          {.cells = ShardOf(plan, 1, 1),
                           .progress = [&left](double, double) { return --left > 0; }}),
                 Cancelled);
  }
  EXPECT_EQ(Run(plan, "stopped.db"), whole);
  EXPECT_EQ(Run(plan, "stopped.db"), whole);  // nothing is left to do
}

TEST_F(SweepTest, FollowsEveryControllerAlongItsOneSetting) {
  const SweepPlan plan = Plan(R"(
question: How long may the mean be?
scenario: base.yaml
controllers: [raw, mean]
seeds: 8
physics: false
axes: [{key: controllers.mean.filter.window, values: [200, 1, 0, 3]}]
scores: [tracking_rmse_deg]
)");
  SweepDatabase kept(Path("study.db"), HashOfSweep(plan), plan.metrics);
  const CellRange all = ShardOf(plan, 1, 1);
  RunSweep(plan, kept, {.jobs = 1, .cells = all});
  const Response response = ReadResponse(plan, kept, all);

  EXPECT_THAT(response.values, ElementsAre(1.0, 3.0, 200.0));  // 0 cannot be built
  EXPECT_THAT(response.controllers, ElementsAre("raw", "mean"));
  ASSERT_EQ(response.verdicts.size(), 1u);
  EXPECT_EQ(response.verdicts[0].controller, "mean");
  EXPECT_EQ(response.comparisons, 3u);
  EXPECT_THAT(response.verdicts[0].judgements,
              ElementsAre(Judgement::kEqual, Judgement::kEqual, Judgement::kWorse));
  for (const auto& scores : response.scores) {
    EXPECT_EQ(scores[0][0].mean, response.scores[0][0][0].mean);  // raw has no window
    EXPECT_EQ(scores[0][0].count, 8);
  }
  EXPECT_EQ(response.scores[0][0][0].mean, response.scores[0][1][0].mean);  // a window of 1
}

TEST_F(SweepTest, HasNoCurveOfTwoSettingsOrOfNames) {
  for (const char* axes : {"[{key: controllers.mean.filter.window, values: [1, 5]}, "
                           "{key: glove.rate_hz, values: [500, 1000]}]",
                           "[{key: controllers.mean.filter, values: [none, moving_average]}]"}) {
    const SweepPlan plan =
        Plan(fmt::format("question: Is there a curve?\nscenario: base.yaml\nseeds: 1\n"
                         "physics: false\naxes: {}\nscores: [tracking_rmse_deg]\n",
                         axes));
    SweepDatabase kept(Path("study.db"), HashOfSweep(plan), plan.metrics);
    const CellRange all = ShardOf(plan, 1, 1);
    RunSweep(plan, kept, {.jobs = 1, .cells = all});
    EXPECT_TRUE(ReadResponse(plan, kept, all).values.empty()) << axes;
    fs::remove(Path("study.db"));
  }
}

TEST_F(SweepTest, RunsRawOnceHoweverManyCellsHaveIt) {
  const SweepPlan plan = LoadSweepPlan(Path("sweep.yaml"));
  Run(plan, "a.db");
  SQLite::Database database(Path("a.db").string());
  EXPECT_EQ(database.execAndGet("SELECT count(*) FROM trial WHERE controller = 'raw'").getInt(),
            2 * 3);  // rates x seeds
  EXPECT_EQ(
      database.execAndGet("SELECT count(*) FROM cell_scores WHERE controller = 'raw'").getInt(),
      2 * 3 * 3);  // cells x seeds
}

TEST_F(SweepTest, MergesShardsIntoTheSameAndTwiceChangesNothing) {
  const SweepPlan plan = LoadSweepPlan(Path("sweep.yaml"));
  const std::string whole = Run(plan, "whole.db");
  for (const int part : {1, 2, 3}) {
    const CellRange cells = ShardOf(plan, part, 3);
    Run(plan, fmt::format("{}.db", part), 1, &cells);
  }
  SweepDatabase merged(Path("merged.db"), HashOfSweep(plan), plan.metrics);
  for (const int part : {1, 2, 3, 2}) merged.Collect(Path(fmt::format("{}.db", part)));
  EXPECT_EQ(Csv(plan, merged), whole);
  EXPECT_EQ(merged.TrialCount(), 2 * 3 * (3 + 1));  // rates, seeds; means and raw
  EXPECT_THROW(merged.Collect(Path("base.yaml")), UserError);
}

TEST_F(SweepTest, ComputesADamagedTrialAgain) {
  const SweepPlan plan = LoadSweepPlan(Path("sweep.yaml"));
  const std::string whole = Run(plan, "a.db");
  SQLite::Database(Path("a.db").string(), SQLite::OPEN_READWRITE)
      .exec("UPDATE score SET value = 99 WHERE trial = 5");
  EXPECT_EQ(Run(plan, "a.db"), whole);
}

TEST_F(SweepTest, HoldsWhatAComparisonOfTheCellHolds) {
  const SweepPlan plan = Plan(With("physics: false", "physics: true"));
  const std::int64_t cell = 5;
  const CellRange only{cell, cell + 1};
  SweepDatabase database(Path("a.db"), HashOfSweep(plan), plan.metrics);
  RunSweep(plan, database, {.cells = only});
  ScenarioSource source = plan.scenario;
  for (const std::string& override : plan.OverridesOf(cell)) source.overrides.push_back(override);
  const Study study = PrepareStudy(ParseScenario(source));
  const StudyResult result = RunStudy(study, {.seeds = 3});
  int seen = 0;
  ForEachCell(plan, database, only, [&](const CellResult& of_cell) {
    const std::size_t controller = of_cell.controller == "raw" ? 0 : 1;
    for (std::size_t i = 0; i < 3; ++i) {
      EXPECT_EQ(of_cell.by_seed[0][i],
                result.seeds[i].controllers[controller].scores.summary[plan.best_by]);
    }
    ++seen;
  });
  EXPECT_EQ(seen, 2);
}

TEST_F(SweepTest, OfAnotherVersionsFileSaysSo) {
  const SweepPlan plan = LoadSweepPlan(Path("sweep.yaml"));
  Run(plan, "a.db");
  SQLite::Database(Path("a.db").string(), SQLite::OPEN_READWRITE).exec("PRAGMA user_version = 4");
  EXPECT_THROW(Run(plan, "a.db"), UserError);
}

TEST(Constraint, IsMetByAnIntervalOrByItsMean) {
  const Constraint at_most = ParseConstraint("jitter_rms_deg <= 0.2", "subject_to");
  const auto interval = [](double mean, double half_width) {
    return MeanInterval{.mean = mean, .low = mean - half_width, .high = mean + half_width};
  };
  EXPECT_EQ(IsMet(at_most, interval(0.1, 0.05)), Met::kYes);
  EXPECT_EQ(IsMet(at_most, interval(0.19, 0.05)), Met::kLikely);
  EXPECT_EQ(IsMet(at_most, interval(0.21, 0.05)), Met::kUnlikely);
  EXPECT_EQ(IsMet(at_most, interval(0.3, 0.05)), Met::kNo);
  EXPECT_EQ(IsMet(at_most, MeanInterval{}), Met::kUnscored);
  const Constraint at_least = ParseConstraint("sparc>=-2", "subject_to");
  EXPECT_EQ(IsMet(at_least, interval(-1.0, 0.5)), Met::kYes);
  EXPECT_EQ(IsMet(at_least, interval(-3.0, 0.5)), Met::kNo);
}

// --- filters without a hand ---------------------------------------------------------------------

/// The scores of one controller without a hand.
std::vector<double> FilterScores(const std::string& controller, const std::string& more = "") {
  test::TemporaryDirectory folder;
  std::ofstream(folder.path() / "base.yaml") << fmt::format(
      "question: what do filters do?\n"
      "glove: {{motion: {{kind: random, duration_s: 4, bandwidth_hz: 1}}, noise: {{kind: "
      "none}}{}}}\n"
      "controllers: {{it: {{{}}}}}\n",
      more, controller);
  const Study study = PrepareStudy(LoadScenario(folder.path() / "base.yaml", {}));
  const StudyResult result =
      RunStudy(study, {.seeds = 1, .keep_first_traces = false, .physics = false});
  return result.seeds[0].controllers[0].scores.summary;
}

TEST(FilterTrial, AMeanDelaysByHalfItsWindow) {
  const auto delay_ms = [](int window) {
    return FilterScores(fmt::format("filter: {{kind: moving_average, window: {}}}",
                                    window))[MetricIndex("delay_ms")];
  };
  // The sensors' cross-talk has a delay of its own.
  EXPECT_NEAR(delay_ms(41) - delay_ms(1), 20.0, 1.0);
}

TEST(FilterTrial, SeesPredictionAndSlowGloves) {
  const std::size_t delay = MetricIndex("delay_ms");
  const double raw = FilterScores("filter: none")[delay];
  const double ahead = FilterScores(
      "filter: {kind: kalman, q: 10}, prediction: {kind: linear, horizon_ms: 30}")[delay];
  EXPECT_LT(ahead, raw - 15.0);
  // A sample of 20 ms is held: half of that on average.
  EXPECT_NEAR(FilterScores("filter: none", ", rate_hz: 50")[delay] - raw, 10.0, 1.0);
}

TEST(FilterTrial, HasNoScoresOfMotors) {
  const std::vector<double> scores = FilterScores("filter: none");
  EXPECT_TRUE(std::isnan(scores[MetricIndex("command_reversals_per_s")]));
  EXPECT_FALSE(std::isnan(scores[MetricIndex("jitter_rms_deg")]));
}

}  // namespace
}  // namespace gauntlet::sim
