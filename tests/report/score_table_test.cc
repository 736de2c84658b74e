#include "sim/report/score_table.h"

#include <gmock/gmock.h>

#include <limits>

#include "tests/report/made_up_study.h"

namespace gauntlet::sim {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

TEST(ScoreTable, ShowsTheGripOnlyWhereSomethingWasHeld) {
  test::MadeUpStudy made = test::MakeUpStudy({});
  const auto table = [&] { return ScoreTable(made, false); };
  EXPECT_THAT(table(), HasSubstr("grip_force_ripple_n"));
  for (ControllerSummary& controller : made.summary.controllers) {
    controller.summary[MetricIndex("grip_force_ripple_n")].mean =
        std::numeric_limits<double>::quiet_NaN();
  }
  EXPECT_THAT(table(), Not(HasSubstr("grip_force_ripple_n")));
  EXPECT_THAT(table(), HasSubstr("tracking_rmse_deg"));
}

TEST(ScoreTable, OfOneSeedClaimsNoIntervalAndNoChance) {
  const test::MadeUpStudy one = test::MakeUpStudy({.seeds = 1});
  const std::string table = ScoreTable(one, false);
  EXPECT_THAT(table, HasSubstr("3 of 3 joints measured; seed 1; reference"));
  EXPECT_THAT(table, HasSubstr("One seed tells nothing about chance"));
  EXPECT_THAT(table, Not(HasSubstr("±")));
  EXPECT_THAT(table, Not(HasSubstr("*")));
  EXPECT_THAT(table, Not(HasSubstr("!")));
  const test::MadeUpStudy five = test::MakeUpStudy({});
  EXPECT_THAT(ScoreTable(five, false),
              AllOf(HasSubstr("seeds 1 to 5"), HasSubstr("±"), HasSubstr("within chance"),
                    Not(HasSubstr("of 5 seeds"))));
}

TEST(ScoreTable, SaysWhenEverySeedGivesTheSameRun) {
  test::MadeUpStudy made = test::MakeUpStudy({.seeds = 1});
  made.result.seeds_alike = true;
  EXPECT_THAT(ScoreTable(made, false), HasSubstr("Every seed gives the same run"));
}

TEST(ScoreTable, NamesTheBaselineAndIsSilentWithoutOne) {
  test::MadeUpStudy made = test::MakeUpStudy({});
  made.study.scenario.baseline = "filter_1";
  made.summary = Summarise(made.study, made.result);
  EXPECT_THAT(ScoreTable(made, false), HasSubstr("! worse than filter_1"));
  made.study.scenario.baseline.clear();
  made.study.scenario.controllers.front().config = made.study.scenario.controllers.back().config;
  made.summary = Summarise(made.study, made.result);
  EXPECT_THAT(ScoreTable(made, false), Not(HasSubstr("worse than")));
}

TEST(ScoreTable, TellsOfHowManySeedsAScoreIs) {
  test::MadeUpStudy made = test::MakeUpStudy({});
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  const std::size_t delay = MetricIndex("delay_ms");
  for (const int seed : {0, 2}) made.result.seeds[seed].controllers[1].scores.summary[delay] = kNaN;
  for (SeedOutcome& seed : made.result.seeds) seed.controllers[2].scores.summary[delay] = kNaN;
  made.summary = Summarise(made.study, made.result);
  const std::string table = ScoreTable(made, false);
  EXPECT_THAT(table, HasSubstr("filter_1: delay_ms from 3 of 5 seeds; the others have none\n"));
  EXPECT_THAT(table, Not(HasSubstr("filter_2: ")));  // a "-" says it
}

}  // namespace
}  // namespace gauntlet::sim
