#include "sim/report/score_table.h"

#include <gmock/gmock.h>

#include <limits>

#include "tests/report/made_up_study.h"

namespace gauntlet::sim {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

TEST(ScoreTable, ShowsTheGripOnlyWhereSomethingWasHeld) {
  test::MadeUpStudy made = test::MakeUpStudy({});
  const auto table = [&] { return ScoreTable(made.study, made.result, made.summary, {}); };
  EXPECT_THAT(table(), HasSubstr("grip_force_ripple_n"));
  for (ControllerSummary& controller : made.summary.controllers) {
    controller.summary[MetricIndex("grip_force_ripple_n")].mean =
        std::numeric_limits<double>::quiet_NaN();
  }
  EXPECT_THAT(table(), Not(HasSubstr("grip_force_ripple_n")));
  EXPECT_THAT(table(), HasSubstr("tracking_rmse_deg"));
}

}  // namespace
}  // namespace gauntlet::sim
