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
  summary.one_run = false;
  summary.causes.seeds = 1;
  EXPECT_THAT(SharesNote(summary), HasSubstr("squared error (first seed): "));
  summary.causes.seeds = 2;
  EXPECT_THAT(SharesNote(summary), HasSubstr("squared error: "));
  summary.causes.seeds = 1;
  summary.one_run = true;
  EXPECT_THAT(SharesNote(summary), HasSubstr("squared error: "));
  summary.controllers = {Controller("raw", {})};
  EXPECT_EQ(SharesNote(summary), "");
}

/// A summary with errors without each cause of one controller.
Summary Switched(bool one_run, int seeds) {
  Summary summary;
  summary.controllers = {Controller("mean", {}), Controller("raw", {})};
  summary.answer.order = {0, 1};
  summary.baseline = 1;
  summary.one_run = one_run;
  summary.causes.switched = true;
  summary.causes.seeds = seeds;
  std::vector<MeanInterval>& values = summary.controllers[1].summary;
  values[ErrorWithAll()].mean = 6.97;
  const double errors[] = {6.96, 6.5, 4.95, 6.97, 7.31, 3.69};
  for (std::size_t i = 0; i < std::size(errors); ++i) {
    values[SwitchedErrors()[i].metric].mean = errors[i];
  }
  return summary;
}

TEST(CausesText, HasTheErrorWithoutEachCauseTheLargestDifferenceFirst) {
  const std::string text =
      "Tracking error of raw without the servo: 3.69 deg in place of 6.97; without the link: 4.95; "
      "without glove errors: 6.50; without friction: 7.31";
  EXPECT_EQ(CausesText(Switched(true, 1)), text + ".");
  Summary first = Switched(false, 1);
  EXPECT_EQ(CausesText(first), text + " (first seed).");
  first.causes.stretch_s = 8.0;
  EXPECT_EQ(CausesText(first), text + " (first 8 s of the first seed).");
  Summary one = Switched(true, 1);
  one.causes.stretch_s = 7.8;
  EXPECT_EQ(CausesText(one), text + " (first 7.8 s).");
}

TEST(CausesText, HasIntervalsWhereAllSeedsWereComputed) {
  Summary all = Switched(false, 8);
  for (const CauseMetric& error : SwitchedErrors()) {
    MeanInterval& value = all.controllers[1].summary[error.metric];
    value.low = value.mean - 0.2;
    value.high = value.mean + 0.2;
  }
  EXPECT_EQ(CausesText(all),
            "Tracking error of raw without the servo: 3.69 ±0.20 deg in place of 6.97; without the "
            "link: 4.95 ±0.20; without glove errors: 6.50 ±0.20; without friction: 7.31 ±0.20.");
}

TEST(CausesText, SaysHowToAskForWhatWasLeftOut) {
  Summary summary;
  EXPECT_EQ(CausesText(summary), "");
  summary.causes.is_left_out = true;
  summary.causes.cost_of_first = 6.5;
  EXPECT_EQ(
      CausesText(summary),
      "Causes of the error: option --causes first computes them, in about 6.5 times the time.");
  // The stretch was not typical of any controller.
  Summary untypical = Switched(true, 1);
  untypical.causes.ticks = 4000;
  untypical.causes.cost_of_first = 6.5;
  EXPECT_THAT(CausesText(untypical), testing::StartsWith("Tracking error of raw"));
  untypical.controllers[1].summary[ErrorWithAll()].mean = kNan;
  EXPECT_EQ(CausesText(untypical), CausesText(summary));
}

TEST(SwitchedTable, HasARowOfEachControllerOfWhichTrialsRan) {
  EXPECT_EQ(TextOf(SwitchedTable(Switched(true, 1)), {}),
            "                          glove   glove   the   motor              the\n"
            "deg RMS without  nothing  noise  errors  link  limits  friction  servo\n"
            "raw                 6.97   6.96    6.50  4.95    6.97      7.31   3.69\n");
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
  EXPECT_THAT(TextOf(ScoreText(made, true), {}), HasSubstr("deg RMS without  nothing"));
  const auto switched = PageData(made, made.first_seed())["switched"];
  EXPECT_EQ(switched["names"].size(), 1 + kSwitchedCauseCount);
  EXPECT_EQ(switched["controllers"][2][3],
            made.summary.controllers[2].summary[MetricIndex("error_without_link_deg")].mean);
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
