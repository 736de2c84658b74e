// The error's causes as a person sees them: shares that sum to the whole, and parts below 0 as they
// are.
#include "sim/show/pages/error_split_table.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <string>
#include <vector>

#include "sim/base/csv_line.h"
#include "sim/base/json.h"
#include "sim/show/pages/page_data.h"
#include "sim/show/pages/score_table.h"
#include "tests/report/made_up_study.h"

namespace gauntlet::sim {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
// Without links; sum to 20.
const std::vector<double> kParts = {-0.44, 2.4, kNan, kNan, 6.2, 3.2, 4.0, 2.0, 0.04, 2.6};
const std::vector<double> kLinkParts = {-0.44, 2.4, 1.2, 2.0, 3.0, 3.2, 4.0, 2.0, 0.04, 2.6};

ControllerSummary Controller(const std::string& name, const std::vector<double>& parts) {
  ControllerSummary controller;
  controller.name = name;
  controller.summary.assign(Metrics().size(), {kNan, kNan, kNan});
  for (std::size_t i = 0; i < parts.size(); ++i) {
    controller.summary[TrackingErrorParts()[i].metric].mean = parts[i];
  }
  return controller;
}

TEST(ErrorSplitTable, TellsTheShareOfEveryCause) {
  Summary summary;
  summary.controllers = {Controller("raw", kParts), Controller("a_name_of_a_filter", kParts)};
  summary.answer.order = {0, 1};
  EXPECT_EQ(TextOf(ErrorSplitTable(summary), {}),
            "                                        motor\n"
            "of squared error    noise  glove  link  limit  friction  servo  rest  control\n"
            "raw                  -2 %   12 %  31 %   16 %      20 %   10 %   0 %     13 %\n"
            "a_name_of_a_filter   -2 %   12 %  31 %   16 %      20 %   10 %   0 %     13 %\n");
}

TEST(ErrorSplitTable, SplitsTheCauseLinkWhereThereAreLinks) {
  Summary summary;
  summary.controllers = {Controller("raw", kParts), Controller("wifi", kLinkParts)};
  summary.answer.order = {0, 1};
  EXPECT_THAT(
      TextOf(ErrorSplitTable(summary), {}),
      testing::StartsWith(
          "                                link    link        motor\n"
          "of squared error  noise  glove  loss  jitter  link  limit  friction  servo  rest\n"
          "raw                -2 %   12 %     -       -  31 %   16 %      20 %   10 %   0 %\n"
          "wifi               -2 %   12 %   6 %    10 %  15 %   16 %      20 %   10 %   0 %\n"));
}

/// A cause that could not be taken away has no share, and the others sum to the whole.
TEST(ErrorSplitTable, HasNoShareOfWhatIsNotKnown) {
  Summary summary;
  summary.controllers = {Controller("raw", {kNan, kNan, kNan, kNan, 10, 0, 0, 0, 0, 10})};
  summary.answer.order = {0};
  EXPECT_THAT(TextOf(ErrorSplitTable(summary), {}),
              testing::ContainsRegex("raw +- +- +50 % +0 % +0 % +0 % +0 % +50 %"));
}

TEST(ErrorSplitTable, SaysWhereItIsOfOneSeedOfSeveral) {
  Summary summary;
  summary.controllers = {Controller("raw", kParts)};
  summary.answer.order = {0};
  int& seeds = summary.controllers[0].summary[TrackingErrorParts().back().metric].count;
  summary.one_run = false;
  seeds = 1;
  EXPECT_THAT(CausesNote(summary),
              HasSubstr("first seed. Option --causes all computes them for all seeds"));
  seeds = 2;
  EXPECT_EQ(CausesNote(summary), "");
  summary.one_run = true;
  seeds = 1;
  EXPECT_EQ(CausesNote(summary), "");
}

TEST(ErrorSplitTable, LeavesOutWhatHasNoSplit) {
  Summary summary;
  summary.controllers = {Controller("raw", {}), Controller("mean", kParts)};
  summary.answer.order = {0, 1};
  EXPECT_THAT(TextOf(ErrorSplitTable(summary), {}), Not(HasSubstr("raw")));
  EXPECT_TRUE(ErrorByCause(summary.controllers[0]).empty());
  summary.controllers.pop_back();
  summary.answer.order = {0};
  EXPECT_TRUE(ErrorSplitTable(summary).rows.empty());
}

TEST(ErrorSplitTable, FitsBesideOtherTextAtATerminal) {
  Summary summary;
  summary.controllers = {Controller("raw", {1e-9, 0, kNan, kNan, 0, 0, 0, 0, 0, 1}),
                         Controller("mean", kParts)};
  summary.answer.order = {0, 1};
  for (const std::string_view line : SplitLines(TextOf(ErrorSplitTable(summary), {}))) {
    EXPECT_LE(line.size(), 80u) << line;
  }
}

TEST(ErrorSplitTable, TheTableOfScoresAndThePageHaveIt) {
  test::MadeUpStudy made = test::MakeUpStudy({});
  EXPECT_THAT(TextOf(ScoreText(made, true), {}), HasSubstr("of squared error "));
  const auto json = PageData(made, made.first_seed())["error_split"];
  EXPECT_EQ(json["parts"].size(), TrackingErrorParts().size());
  EXPECT_EQ(json["colours"].size(), json["parts"].size());
  EXPECT_EQ(json["parts"][0], "noise");
  EXPECT_EQ(json["controllers"].size(), 3u);
  const auto first = json["controllers"][0].get<std::vector<double>>();
  EXPECT_EQ(first, ErrorByCause(made.summary.controllers[0]));

  for (ControllerSummary& controller : made.summary.controllers) {
    controller.summary[TrackingErrorParts().back().metric].mean =
        std::numeric_limits<double>::quiet_NaN();
  }
  EXPECT_THAT(TextOf(ScoreText(made, true), {}), Not(HasSubstr("of squared error")));
  EXPECT_TRUE(PageData(made, made.first_seed())["error_split"].is_null());
}

}  // namespace
}  // namespace gauntlet::sim
