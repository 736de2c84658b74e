// Robustness: which hands are tried, and that made-up scores give the shares and bars they must.
#include "sim/answers/robust/robust.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "sim/answers/robust/robust_tables.h"
#include "sim/base/error.h"
#include "sim/base/json.h"
#include "sim/study/scenario/scenario_reader.h"
#include "tests/support/program.h"

namespace gauntlet::sim {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

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
    return MakeRobustPlan({.file = folder_.path() / "base.yaml", .text = text_}, options);
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
  /// `failed`: of this controller one cell has no scores.
  std::unique_ptr<SweepDatabase> MadeUp(const RobustPlan& plan, std::int64_t not_built = -1,
                                        const std::string& failed = "") const {
    auto database = std::make_unique<SweepDatabase>(folder_.path() / "made_up.db", "made up",
                                                    plan.sweep.metrics);
    for (std::int64_t cell = 0; cell < plan.sweep.cell_count(); ++cell) {
      SweepCellRecord record{.number = cell,
                             .controller = {},
                             .study = std::to_string(cell),
                             .settings = {},
                             .motions = {},
                             .problem = {}};
      if (cell == not_built && failed.empty()) {
        record.problem = "too soft";
        database->AddCell(record, {});
        continue;
      }
      record.motions.assign(static_cast<std::size_t>(plan.sweep.file.seeds), 0);
      for (const std::string& name : names_) {
        record.controller = record.settings = name;
        record.problem = cell == not_built && name == failed ? "diverged" : "";
        database->AddCell(record, {});
        for (int seed = 1; seed <= plan.sweep.file.seeds; ++seed) {
          TrialOutcome outcome;
          outcome.scores.summary.assign(Metrics().size(), std::nan(""));
          const double noise = 10.0 * (NoiseFactor(plan, cell) - 1.0);
          outcome.scores.summary[plan.sweep.best_by] =
              0.3 * seed + (name == "steady" ? 6.0
                            : name == "slow" ? 9.0
                                             : 5.0 + noise);
          database->Keep({record.study, record.controller, record.settings, seed}, outcome);
        }
      }
    }
    database->Flush();
    return database;
  }

  test::TemporaryDirectory folder_;
  std::string text_ = kScenario;
  std::vector<std::string> names_ = {"steady", "fragile"};
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

TEST_F(RobustTest, AsksForTheDifferenceOfTheTwoBestOfThree) {
  text_ += "  slow: {filter: {kind: moving_average, window: 50}}\n";
  text_ += "baseline: slow\n";
  names_.emplace_back("slow");
  const RobustPlan plan = Plan({.hands = 4, .seeds = 3});
  const RobustResult result = ConcludeRobust(plan, *MadeUp(plan));
  EXPECT_THAT(result.scores[0].two_best, ElementsAre(1, 0));
  EXPECT_EQ(result.scores[0].controllers[2].name, "slow");
  EXPECT_EQ(result.scores[0].controllers[2].near_best.hits, 0);
  EXPECT_EQ(result.nominal.baseline, 2u);
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
  EXPECT_THAT(result.first_problem, HasSubstr("too soft"));
  EXPECT_EQ(result.scores[0].controllers[0].best.count, 3);
}

TEST_F(RobustTest, HasNoBarWhereOneOfTheTwoFails) {
  for (const std::string failed : {"steady", "fragile"}) {
    const RobustPlan plan = Plan({.hands = 2, .seeds = 2});
    for (const bool is_high : {false, true}) {
      const std::int64_t cell = is_high ? RobustPlan::HighCell(2) : RobustPlan::LowCell(2);
      const RobustResult result = ConcludeRobust(plan, *MadeUp(plan, cell, failed));
      const TornadoBar& last = result.scores[0].bars.back();
      EXPECT_EQ(last.parameter, 2u);
      EXPECT_EQ(last.problem, is_high ? "high: diverged" : "low: diverged");
      EXPECT_EQ(TornadoVerdict(last), "");
      EXPECT_EQ(result.failed, 0) << "of the drawn hands";
    }
    const RobustResult drawn = ConcludeRobust(plan, *MadeUp(plan, plan.FirstHand(), failed));
    EXPECT_EQ(drawn.failed, 1);
    EXPECT_EQ(drawn.not_built, 0);
    EXPECT_EQ(drawn.scores[0].controllers[0].best.count, 2);
    EXPECT_EQ(drawn.first_problem, fmt::format("hand {}: diverged", plan.FirstHand()));
  }
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

/// A result with other numbers in each place: fragile is best on 48 of 50 hands and near on all,
/// steady on 2 and 5; one parameter of each judgement, and one without scores.
class RobustTables : public RobustTest {
 protected:
  RobustTables() : plan_(Plan({.hands = 50, .seeds = 3})) {
    result_ = ConcludeRobust(plan_, *MadeUp(plan_));
    RobustScore& score = result_.scores[0];
    score.controllers[0] = {"steady", EstimateShare(2, 50), EstimateShare(5, 50)};
    score.controllers[1] = {"fragile", EstimateShare(48, 50), EstimateShare(50, 50)};
    using enum Judgement;
    score.bars = {Bar(2, 1.5, 4.0, kWorse), Bar(0, -1.0, -3.0, kBetter), Bar(1, 2.0, 2.25, kEqual),
                  Bar(3, 5.0, 6.0, kUndecided)};
    score.bars.emplace_back().parameter = 4;
    score.bars.back().problem = "low: too soft";
    result_.not_built = 1;
    result_.failed = 2;
    result_.first_problem = "hand 17: too soft";
  }

  static TornadoBar Bar(std::size_t parameter, double low, double high, Judgement judgement) {
    const auto interval = [](double mean, double half) {
      return MeanInterval{.mean = mean, .low = mean - half, .high = mean + half, .count = 9};
    };
    TornadoBar bar;
    bar.parameter = parameter;
    bar.low = interval(low, 0.125);
    bar.high = interval(high, 0.25);
    bar.change = {interval(high - low, 0.375), 0.5, judgement};
    return bar;
  }
  std::string Text(bool verbose) const {
    return TextOf(RobustText(plan_, result_, verbose),
                  {.width = 10'000, .table_width = TerminalStyle::kNoLimit});
  }

  RobustPlan plan_;
  RobustResult result_;
};

// The half of the interval of 6.3, 6.6 and 6.9 is t(2) 0.3 / sqrt(3) = 0.745.
constexpr const char* kText =
    R"(base: Does the verdict hold on 50 other hands?

Use fragile: recommended on the nominal hand, and best or equivalent in tracking error on 50 of 50 hands (95 % CI 92 to 100 %).
The difference in tracking error between fragile and steady is sensitive to inertia and friction; undecided for servo_gain.

                       tracking
best or equivalent on     error
fragile                   50/50
steady                     5/50

50 hands, each with friction, stiffness, inertia, servo_gain, delay, wearer, noise within 30 % of the scenario's; 3 seeds each.
Warning: 1 hand could not be built.
Warning: 2 simulations failed; their controller does not count as best there.
hand 17: too soft
)";
constexpr const char* kMoreText = R"(
tracking_rmse_deg  nominal hand  verdict                    best              equivalent
steady                6.60±0.75    worse     2 of 50 (0 to 14 %)     5 of 50 (3 to 22 %)
fragile               5.60±0.75     best  48 of 50 (86 to 100 %)  50 of 50 (92 to 100 %)

verdict: difference to the best on the nominal hand, as gauntlet compare judges it. best: share of hands with the lowest mean. equivalent: share of hands with a mean within the smallest relevant difference of the lowest. In brackets: 95 % confidence interval of the share, for other hands and the same seeds (Clopper and Pearson).

Sensitivity of fragile - steady in tracking error, one parameter at a time

parameter          low        high  high - low  verdict
inertia      1.50±0.12   4.00±0.25   2.50±0.38  effect
friction    -1.00±0.12  -3.00±0.25  -2.00±0.38  effect
stiffness    2.00±0.12   2.25±0.25   0.25±0.38  no effect
servo_gain   5.00±0.12   6.00±0.25   1.00±0.38  undecided
delay                -           -           -  low: too soft

high - low: paired by seed, simultaneous 95 % confidence intervals (Bonferroni). tornado.csv and report.html contain the other scores.
)";

TEST_F(RobustTables, SayOnHowManyHandsTheVerdictHolds) {
  EXPECT_EQ(Text(false), kText);
  EXPECT_EQ(Text(true), std::string(kText) + kMoreText);
}

TEST_F(RobustTables, SayWhatIsOpen) {
  Verdict& nominal = result_.nominal.answer.verdict;
  nominal.recommended.clear();
  nominal.alternatives = {"steady"};
  result_.scores[0].bars.resize(3);
  result_.scores[0].bars[0].change.judgement = Judgement::kEqual;
  result_.scores[0].bars[1].change.judgement = Judgement::kEqual;
  plan_.not_varied = {"wind"};
  result_.not_built = result_.failed = 0;
  result_.first_problem.clear();
  EXPECT_EQ(JudgedController(plan_, result_), "fragile");
  const std::string text = Text(false);
  EXPECT_THAT(text, HasSubstr("\n\nNo recommendation on the nominal hand: more seeds are needed. "
                              "fragile has the least tracking error there, and is best or "
                              "equivalent on 50 of 50 hands (95 % CI 92 to 100 %).\n"));
  EXPECT_THAT(text, HasSubstr(" between fragile and steady is sensitive to no parameter.\n"));
  EXPECT_THAT(text, HasSubstr("of the scenario's (not wind, which is 0 there); 3 seeds each.\n"));
  EXPECT_THAT(text, Not(HasSubstr("Warning")));
  EXPECT_THAT(VerdictOf(plan_, result_).alternatives, ElementsAre("steady"));
  plan_.not_varied = {"wind", "rain"};
  result_.scores[0].bars.clear();
  EXPECT_THAT(Text(false), HasSubstr("(not wind, rain, which are 0 there)"));
  EXPECT_THAT(Text(true), Not(HasSubstr("ensitiv")));
}

TEST_F(RobustTables, AreFiles) {
  EXPECT_EQ(
      RobustCsv(result_),
      R"(score,controller,nominal,nominal_low,nominal_high,nominal_verdict_to_best,hands,best_hands,best_low,best_high,near_best_hands,near_best_low,near_best_high
tracking_rmse_deg,steady,6.6,5.8547586864749,7.345241313525099,worse,50,2,0.004881433426164384,0.13713762560396686,5,0.03327509358902267,0.21813536643420212
tracking_rmse_deg,fragile,5.6,4.8547586864749,6.345241313525099,best,50,48,0.8628623743960331,0.9951185665738356,50,0.9288782635358022,1
)");
  EXPECT_EQ(
      TornadoCsv(plan_, result_),
      R"(score,first,second,parameter,low,low_low,low_high,high,high_low,high_high,change,change_low,change_high,level,relevant_difference,verdict,problem
tracking_rmse_deg,fragile,steady,inertia,1.5,1.375,1.625,4,3.75,4.25,2.5,2.125,2.875,0.95,0.5,effect,
tracking_rmse_deg,fragile,steady,friction,-1,-1.125,-0.875,-3,-3.25,-2.75,-2,-2.375,-1.625,0.95,0.5,effect,
tracking_rmse_deg,fragile,steady,stiffness,2,1.875,2.125,2.25,2,2.5,0.25,-0.125,0.625,0.95,0.5,no effect,
tracking_rmse_deg,fragile,steady,servo_gain,5,4.875,5.125,6,5.75,6.25,1,0.625,1.375,0.95,0.5,undecided,
tracking_rmse_deg,fragile,steady,delay,,,,,,,,,,,,,low: too soft
)");
  EXPECT_THAT(RobustJson(plan_, result_), testing::StartsWith("{\n \"scenario\": \"base\",\n"));
  const Json json = Json::parse(RobustJson(plan_, result_));
  for (const auto& [key, value] :
       std::vector<std::pair<const char*, Json>>{{"scenario", "base"},
                                                 {"question", "Who is best?"},
                                                 {"hands", 50},
                                                 {"within_percent", 30.0},
                                                 {"seeds", 3},
                                                 {"not_built", 1},
                                                 {"failed", 2}}) {
    EXPECT_EQ(json[key], value) << key;
  }
  EXPECT_EQ(json["verdict"]["recommended"].get<std::string>(), "fragile");
  EXPECT_EQ(json["parameters"].size(), plan_.parameters.size());
  EXPECT_EQ(json["parameters"][0]["is"].get<std::string>(), plan_.parameters[0].help);
  const Json& score = json["scores"][0];
  EXPECT_EQ(score["controllers"][1]["best"]["hands"].get<int>(), 48);
  EXPECT_EQ(score["controllers"][0]["near_best"]["of"].get<int>(), 50);
  EXPECT_EQ(score["tornado"][0]["change"]["mean"].get<double>(), 2.5);
  EXPECT_EQ(score["tornado"][4]["problem"].get<std::string>(), "low: too soft");
}

TEST_F(RobustTest, ScalesAllSettingsOfAParameter) {
  const RobustPlan plan = Plan({.within_percent = 25.0});
  const std::vector<std::pair<std::string, std::string>> parameter_of = {
      {"hand.servo.friction_scale", "friction"},
      {"hand.cable.capstan_friction", "friction"},
      {"hand.cable.stiffness_scale", "stiffness"},
      {"hand.arm_servo.inertia_scale", "inertia"},
      {"event.delay_ms", "delay"},
      {"glove.sensor.gain_deviation_percent", "wearer"},
      {"glove.sensor.hysteresis_deg", "wearer"},
      {"glove.noise.variance_scale", "noise"}};
  for (std::size_t p = 0; p < plan.parameters.size(); ++p) {
    for (const auto& [key, name] : parameter_of) {
      const bool is_scaled = plan.parameters[p].name == name;
      const double nominal = At(plan, 0, key);
      EXPECT_GT(nominal, 0.0) << key;
      EXPECT_NEAR(At(plan, RobustPlan::LowCell(p), key) / nominal, is_scaled ? 0.75 : 1.0, 1e-5);
      EXPECT_NEAR(At(plan, RobustPlan::HighCell(p), key) / nominal, is_scaled ? 1.25 : 1.0, 1e-5);
    }
  }
  EXPECT_EQ(plan.sweep.file.seeds, 8);
  EXPECT_EQ(plan.hands, 32);
  EXPECT_EQ(plan.within_percent, 25.0);
  EXPECT_EQ(Plan({.seeds = 3}).sweep.file.seeds, 3);
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
