// Robustness: which hands are tried, and that made-up scores give the shares and bars they must.
#include "sim/answers/robust/robust.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <memory>

#include "sim/answers/robust/robust_tables.h"
#include "sim/base/error.h"
#include "sim/study/scenario/scenario_reader.h"
#include "tests/support/program.h"

namespace gauntlet::sim {
namespace {

using testing::ElementsAre;

constexpr const char* kScenario = R"(
question: Who is best?
glove:
  motion: {kind: random, duration_s: 0.3, bandwidth_hz: 2}
score: {noise_free_twin: false}
event: {delay_ms: 40}
controllers:
  steady: {filter: {kind: moving_average, window: 5}}
  fragile: {filter: none}
)";

class RobustTest : public testing::Test {
 protected:
  RobustTest() { std::ofstream(folder_.path() / "base.yaml") << kScenario; }

  RobustPlan Plan(const RobustOptions& options) const {
    return MakeRobustPlan({.file = folder_.path() / "base.yaml", .text = kScenario}, options);
  }
  /// The number that a cell has at this key.
  static double At(const RobustPlan& plan, std::int64_t cell, const std::string& key) {
    const auto& axes = plan.sweep.file.axes;
    const auto axis = std::ranges::find(axes, key, &SweepAxis::key) - axes.begin();
    return std::stod(plan.sweep.ValuesOf(cell)[static_cast<std::size_t>(axis)]);
  }
  static double NoiseFactor(const RobustPlan& plan, std::int64_t cell) {
    return At(plan, cell, "glove.noise.variance_scale");
  }

  /// A database in which `fragile` tracks 1 deg better than `steady` on the scenario's own hand, by
  /// 10 deg for each unit of the noise's factor less; all seeds alike but for `scatter`, which both
  /// share.
  std::unique_ptr<SweepDatabase> MadeUp(const RobustPlan& plan, std::int64_t not_built = -1) const {
    auto database = std::make_unique<SweepDatabase>(folder_.path() / "made_up.db", "made up",
                                                    plan.sweep.metrics);
    for (std::int64_t cell = 0; cell < plan.sweep.cell_count(); ++cell) {
      SweepCellRecord record{.number = cell,
                             .controller = {},
                             .study = std::to_string(cell),
                             .settings = {},
                             .motions = {},
                             .problem = {}};
      if (cell == not_built) {
        record.problem = "too soft";
        database->AddCell(record, {});
        continue;
      }
      record.motions.assign(static_cast<std::size_t>(plan.sweep.file.seeds), 0);
      for (const char* name : {"steady", "fragile"}) {
        record.controller = record.settings = name;
        database->AddCell(record, {});
        for (int seed = 1; seed <= plan.sweep.file.seeds; ++seed) {
          TrialOutcome outcome;
          outcome.scores.summary.assign(Metrics().size(), std::nan(""));
          const double noise = 10.0 * (NoiseFactor(plan, cell) - 1.0);
          outcome.scores.summary[plan.sweep.best_by] =
              0.3 * seed + (record.controller == "steady" ? 6.0 : 5.0 + noise);
          database->Keep({record.study, record.controller, record.settings, seed}, outcome);
        }
      }
    }
    database->Flush();
    return database;
  }

  test::TemporaryDirectory folder_;
};

TEST_F(RobustTest, VariesOneParameterAtATimeAndThenAllTogether) {
  const RobustPlan plan = Plan({.hands = 40, .within_percent = 20.0});
  ASSERT_EQ(plan.sweep.cell_count(), plan.FirstHand() + 40);
  EXPECT_EQ(At(plan, 0, "event.delay_ms"), 40.0);
  for (std::size_t p = 0; p < plan.parameters.size(); ++p) {
    const bool delay = plan.parameters[p].name == "delay";
    EXPECT_EQ(At(plan, RobustPlan::LowCell(p), "event.delay_ms"), delay ? 32.0 : 40.0);
    EXPECT_EQ(At(plan, RobustPlan::HighCell(p), "event.delay_ms"), delay ? 48.0 : 40.0);
    const double error_deg = At(plan, 0, "hand.servo.full_torque_error_deg");
    EXPECT_NEAR(At(plan, RobustPlan::HighCell(p), "hand.servo.full_torque_error_deg"),
                plan.parameters[p].name == "servo_gain" ? error_deg / 1.2 : error_deg, 1e-4);
  }
  double least = 100.0;
  double most = 0.0;
  for (std::int64_t cell = plan.FirstHand(); cell < plan.sweep.cell_count(); ++cell) {
    // Settings of one parameter have one factor; those of two have their own.
    const double delay = At(plan, cell, "event.delay_ms") / 40.0;
    EXPECT_NEAR(At(plan, cell, "hand.servo.dead_time_ms") / At(plan, 0, "hand.servo.dead_time_ms"),
                delay, 1e-5);
    EXPECT_NE(NoiseFactor(plan, cell), delay);
    least = std::min(least, delay);
    most = std::max(most, delay);
  }
  EXPECT_GE(least, 0.8);
  EXPECT_LE(most, 1.2);
  EXPECT_LT(least, 0.85);
  EXPECT_GT(most, 1.15);
  EXPECT_NE(Plan({.design_seed = 2}).sweep.ValuesOf(plan.FirstHand()),
            Plan({}).sweep.ValuesOf(plan.FirstHand()));
}

TEST_F(RobustTest, RefusesOneController) {
  EXPECT_THROW(Plan({.controllers = {"steady"}}), UserError);
}

TEST_F(RobustTest, CountsTheHandsOnWhichEachIsBest) {
  const RobustPlan plan = Plan({.hands = 50, .seeds = 3});
  const auto database = MadeUp(plan);
  const RobustResult result = ConcludeRobust(plan, *database);
  int fragile = 0;
  int near = 0;
  for (std::int64_t cell = plan.FirstHand(); cell < plan.sweep.cell_count(); ++cell) {
    const double behind = 10.0 * (NoiseFactor(plan, cell) - 1.0) - 1.0;
    if (behind < 0.0) ++fragile;
    if (behind < 0.5) ++near;  // kFeltAngle
  }
  ASSERT_EQ(result.scores.size(), 1u);
  const std::vector<RobustController>& controllers = result.scores[0].controllers;
  EXPECT_EQ(controllers[0].name, "steady");
  EXPECT_EQ(controllers[0].best.hits, 50 - fragile);
  EXPECT_EQ(controllers[1].best.hits, fragile);
  EXPECT_EQ(controllers[1].near_best.hits, near);
  EXPECT_EQ(controllers[1].best.count, 50);
  EXPECT_LT(controllers[1].best.low, controllers[1].best.value());
  EXPECT_GT(controllers[1].best.high, controllers[1].best.value());
  EXPECT_THAT(result.scores[0].two_best, ElementsAre(1, 0));
  EXPECT_EQ(result.nominal.Of(plan.sweep.best_by, 1, 0).judgement, Judgement::kBetter);
}

TEST_F(RobustTest, TheTornadoNamesTheParameterThatMatters) {
  const RobustPlan plan = Plan({.hands = 2, .seeds = 3});
  const auto database = MadeUp(plan);
  const RobustResult result = ConcludeRobust(plan, *database);
  const std::vector<TornadoBar>& bars = result.scores[0].bars;
  ASSERT_EQ(bars.size(), plan.parameters.size());
  EXPECT_EQ(plan.parameters[bars[0].parameter].name, "noise");
  EXPECT_NEAR(bars[0].low.mean, -4.0, 1e-9);  // 10 x -0.3 - 1
  EXPECT_NEAR(bars[0].high.mean, 2.0, 1e-9);  // 10 x +0.3 - 1
  EXPECT_NEAR(bars[0].change.difference.mean, 6.0, 1e-9);
  EXPECT_EQ(TornadoVerdict(bars[0]), "effect");
  for (std::size_t i = 1; i < bars.size(); ++i) {
    EXPECT_EQ(TornadoVerdict(bars[i]), "no effect");
  }
}

TEST_F(RobustTest, KeepsAHandThatCannotBeBuiltWithItsReason) {
  const RobustPlan plan = Plan({.hands = 4, .seeds = 2});
  const auto database = MadeUp(plan, plan.FirstHand() + 1);
  const RobustResult result = ConcludeRobust(plan, *database);
  EXPECT_EQ(result.not_built, 1);
  EXPECT_THAT(result.first_problem, testing::HasSubstr("too soft"));
  EXPECT_EQ(result.scores[0].controllers[0].best.count, 3);
}

TEST_F(RobustTest, NeedsTheOwnHand) {
  const RobustPlan plan = Plan({.hands = 1, .seeds = 2});
  EXPECT_THROW(ConcludeRobust(plan, *MadeUp(plan, 0)), RunError);
}

TEST_F(RobustTest, OnTheOwnHandSaysWhatAComparisonSays) {
  const RobustPlan plan = Plan({.hands = 1, .seeds = 2});
  SweepDatabase database(folder_.path() / "study.db", HashOfSweep(plan.sweep), plan.sweep.metrics);
  RunSweep(plan.sweep, database, {.jobs = 2, .cells = ShardOf(plan.sweep, 1, 1)});
  const RobustResult result = ConcludeRobust(plan, database);
  const Study study = PrepareStudy(LoadScenario(folder_.path() / "base.yaml", {}));
  const Summary compared =
      Summarise(study, RunStudy(study, {.seeds = 2, .keep_first_traces = false}));
  // A delay may be a mean over other joints: see docs/explanation/scores.md.
  for (const std::size_t metric :
       {MetricIndex("tracking_rmse_deg"), MetricIndex("aligned_rmse_deg")}) {
    for (std::size_t c = 0; c < 2; ++c) {
      EXPECT_EQ(result.nominal.controllers[c].summary[metric].mean,
                compared.controllers[c].summary[metric].mean);
    }
    EXPECT_EQ(result.nominal.Of(metric, 0, 1).difference.mean,
              compared.Of(metric, 0, 1).difference.mean);
  }
}

TEST(Share, HasTheIntervalOfClopperAndPearson) {
  const Share none = EstimateShare(0, 10);
  EXPECT_EQ(none.low, 0.0);
  EXPECT_NEAR(none.high, 1.0 - std::pow(0.025, 0.1), 1e-9);
  const Share all = EstimateShare(10, 10);
  EXPECT_NEAR(all.low, std::pow(0.025, 0.1), 1e-9);
  EXPECT_EQ(all.high, 1.0);
  const Share half = EstimateShare(5, 10);
  EXPECT_NEAR(half.low, 0.18708603, 1e-7);  // R: binom.test(5, 10)
  EXPECT_NEAR(half.high, 0.81291397, 1e-7);
  EXPECT_EQ(EstimateShare(0, 0).high, 1.0);
}

}  // namespace
}  // namespace gauntlet::sim
