// The error's causes as a person sees them: shares that sum to the whole, and parts below 0 as they
// are.
#include "sim/report/error_split_table.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <string>
#include <vector>

#include "sim/base/csv_line.h"
#include "sim/report/page_data.h"
#include "sim/report/score_table.h"
#include "tests/report/made_up_study.h"

namespace gauntlet::sim {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

const std::vector<double> kParts = {12.2, 2.4, 0.6, 3.2, 0.04, -0.44, 2.0};  // sum to 20

ControllerSummary Controller(const std::string& name, const std::vector<double>& parts) {
  ControllerSummary controller;
  controller.name = name;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  controller.summary.assign(Metrics().size(), {nan, nan, nan});
  for (std::size_t i = 0; i < parts.size(); ++i) {
    controller.summary[TrackingErrorParts()[i].metric].mean = parts[i];
  }
  return controller;
}

TEST(ErrorSplitTable, TellsTheShareOfEveryCause) {
  Summary summary;
  summary.controllers = {Controller("raw", kParts),
                         Controller("a_longer_name_of_a_filter", kParts)};
  EXPECT_EQ(TextOf(ErrorSplitTable(summary), {}),
            "                                                  motors'\n"
            "of the squared error       delay  constant  gain    limit  frames  noise  rest\n"
            "raw                         61 %      12 %   3 %     16 %     0 %   -2 %  10 %\n"
            "a_longer_name_of_a_filter   61 %      12 %   3 %     16 %     0 %   -2 %  10 %\n");
}

TEST(ErrorSplitTable, LeavesOutWhatHasNoSplit) {
  Summary summary;
  summary.controllers = {Controller("raw", {}), Controller("mean", kParts)};
  EXPECT_THAT(TextOf(ErrorSplitTable(summary), {}), Not(HasSubstr("raw")));
  EXPECT_TRUE(ErrorByCause(summary.controllers[0]).empty());
  summary.controllers.pop_back();
  EXPECT_TRUE(ErrorSplitTable(summary).rows.empty());
}

TEST(ErrorSplitTable, FitsBesideOtherTextAtATerminal) {
  Summary summary;
  summary.controllers = {Controller("raw", {1e-9, 0, 0, 0, 0, 0, 1}), Controller("mean", kParts)};
  for (const std::string_view line : SplitLines(TextOf(ErrorSplitTable(summary), {}))) {
    EXPECT_LE(line.size(), 80u) << line;
  }
}

TEST(ErrorSplitTable, TheTableOfScoresAndThePageHaveIt) {
  test::MadeUpStudy made = test::MakeUpStudy({});
  EXPECT_THAT(TextOf(ScoreText(made), {}), HasSubstr("\nof the squared error "));
  const auto json = PageData(made, made.first_seed())["error_split"];
  EXPECT_EQ(json["parts"].size(), TrackingErrorParts().size());
  EXPECT_EQ(json["parts"][0], "delay");
  EXPECT_EQ(json["controllers"].size(), 3u);
  const auto first = json["controllers"][0].get<std::vector<double>>();
  EXPECT_EQ(first, ErrorByCause(made.summary.controllers[0]));

  for (ControllerSummary& controller : made.summary.controllers) {
    controller.summary[TrackingErrorParts()[2].metric].mean =
        std::numeric_limits<double>::quiet_NaN();
  }
  EXPECT_THAT(TextOf(ScoreText(made), {}), Not(HasSubstr("of the squared error")));
  EXPECT_TRUE(PageData(made, made.first_seed())["error_split"].is_null());
}

}  // namespace
}  // namespace gauntlet::sim
