#include "sim/show/pages/page_data.h"

#include <gtest/gtest.h>

#include "sim/base/json.h"
#include "sim/results/html_text.h"
#include "sim/show/pages/curve_codec.h"
#include "sim/show/pages/report_page.h"
#include "tests/report/curve_decoder.h"
#include "tests/report/made_up_study.h"

namespace gauntlet::sim {
namespace {

Json Data(const test::MadeUpStudy& made) { return PageData(made, made.first_seed()); }

std::string Page(const test::MadeUpStudy& made) {
  return AssemblePage(
      {.head = {.title = made.study.scenario.name, .question = made.study.scenario.question},
       .data = JsonForScript(Data(made)),
       .resolved_scenario = ""});
}

/// The content of <script type="application/json">.
Json DataOfPage(const std::string& page) {
  const std::string open = R"(<script type="application/json" id="data">)";
  const std::size_t begin = page.find(open) + open.size();
  return Json::parse(page.substr(begin, page.find("</script>", begin) - begin));
}

TEST(ReportPage, ShowsAPosterBesideItAndNoOtherPicture) {
  const auto page = [](bool has_poster) {
    return AssemblePage({.head = {},
                         .data = "{}",
                         .resolved_scenario = "",
                         .video = {.exists = true, .has_poster = has_poster}});
  };
  EXPECT_NE(page(true).find("src=\"comparison.mp4\" poster=\"poster.png\""), std::string::npos);
  EXPECT_NE(page(true).find("img-src data: 'self' file:\""), std::string::npos);
  EXPECT_EQ(page(false).find("poster.png"), std::string::npos);
  EXPECT_NE(page(false).find("img-src data:\""), std::string::npos);
}

TEST(PageData, HasTheSummaryOfEveryController) {
  const test::MadeUpStudy made = test::MakeUpStudy({});
  const Json data = Data(made);
  ASSERT_EQ(data["controllers"].size(), 3U);
  ASSERT_EQ(data["metrics"].size(), Metrics().size());
  for (std::size_t c = 0; c < 3; ++c) {
    for (std::size_t m = 0; m < Metrics().size(); ++m) {
      const MeanInterval& expected = made.summary.controllers[c].summary[m];
      EXPECT_EQ(data["controllers"][c]["summary"][m],
                Json({expected.mean, expected.low, expected.high, 5}));
    }
  }
  EXPECT_EQ(data["baseline"], "raw");
  EXPECT_EQ(data["controllers"][0]["baseline"], true);
  EXPECT_TRUE(data["controllers"][0]["to_baseline"].empty());
  ASSERT_EQ(data["controllers"][1]["to_baseline"].size(), Metrics().size());
  const Comparison& expected = made.summary.controllers[1].to_baseline[3];
  const Json& difference = data["controllers"][1]["to_baseline"][3];
  EXPECT_EQ(difference["mean"], expected.difference.mean);
  EXPECT_EQ(difference["low"], expected.difference.low);
  EXPECT_EQ(difference["high"], expected.difference.high);
  EXPECT_EQ(difference["level"], expected.difference.level);
  EXPECT_EQ(difference["relevant_difference"], expected.relevant_difference);
  EXPECT_EQ(difference["verdict"], JudgementText(expected.judgement));
  EXPECT_EQ(data["controllers"][1]["marks"].get<std::string>()[3], made.summary.MarkOf(1, 3));
  EXPECT_EQ(data["controllers"][2]["marks"].get<std::string>().size(), Metrics().size());
}

TEST(PageData, CurvesAreTheTracesInDegrees) {
  const test::MadeUpStudy made = test::MakeUpStudy({});
  const Json curves = Data(made)["curves"];
  EXPECT_EQ(curves["samples_per_bucket"], 1);
  const std::vector<double> hand =
      test::DecodeCurve(curves["channels"][1]["controllers"][2]["hand"].get<std::string>(),
                        curves["step_deg"].get<double>());
  const Signal& expected = made.hand_rad[2];
  ASSERT_EQ(static_cast<Eigen::Index>(hand.size()), expected.rows());
  for (Eigen::Index k = 0; k < expected.rows(); ++k) {
    ASSERT_NEAR(hand[static_cast<std::size_t>(k)], expected(k, 1) * kDegPerRad,
                0.5001 * kCurveStepDeg);
  }
}

TEST(PageData, WritesScoresThatDoNotExistAsNull) {
  test::MadeUpStudy made = test::MakeUpStudy({});
  made.summary.controllers[1].summary[0] = {NAN, NAN, NAN};
  const Json data = DataOfPage(Page(made));
  EXPECT_EQ(data["controllers"][1]["summary"][0], Json({nullptr, nullptr, nullptr, 0}));
}

TEST(PageData, OfOneSeedIsNoComparison) {
  EXPECT_EQ(Data(test::MakeUpStudy({.seeds = 1}))["comparison"], false);
  EXPECT_EQ(Data(test::MakeUpStudy({.seeds = 2}))["comparison"], true);
}

TEST(PageData, LeavesCurvesOutWhereNoTraceWasKept) {
  const test::MadeUpStudy made = test::MakeUpStudy({});
  EXPECT_TRUE(PageData(made, FirstSeed())["curves"].is_null());
}

TEST(PageData, TakesAHandThatWasStoppedEarly) {
  test::MadeUpStudy made = test::MakeUpStudy({});
  made.hand_rad[1].KeepRows(100);
  made.summary.controllers[1].problem = "at 0.1 s: bad value in qacc (dof 12)";
  const Json data = Data(made);
  EXPECT_EQ(data["controllers"][1]["problem"], "at 0.1 s: bad value in qacc (dof 12)");
  const auto hand = data["curves"]["channels"][0]["controllers"][1]["hand"].get<std::string>();
  EXPECT_EQ(test::DecodeCurve(hand, kCurveStepDeg).size(), 100U);
}

TEST(ReportPage, NamesOfAUserStayText) {
  test::MadeUpStudy made = test::MakeUpStudy({});
  const std::string nasty = "</script><script>alert('1')</script>{{data}}<img src=x onerror=y>";
  made.study.scenario.name = nasty;
  made.study.scenario.question = nasty;
  made.summary.controllers[1].name = nasty;
  const std::string page = Page(made);
  EXPECT_EQ(page.find("alert('1')</script>"), std::string::npos);
  EXPECT_EQ(page.find("<img"), std::string::npos);
  EXPECT_EQ(DataOfPage(page)["controllers"][1]["name"], nasty);
  EXPECT_EQ(DataOfPage(page)["scenario"], nasty);
}

TEST(ReportPage, NamesNothingOutsideOfItself) {
  const std::string page = Page(test::MakeUpStudy({}));
  for (const char* outside : {"src=\"http", "href=\"http", "url(", "@import", "sourceMappingURL"}) {
    EXPECT_EQ(page.find(outside), std::string::npos) << outside;
  }
  EXPECT_NE(page.find("default-src 'none'"), std::string::npos);
}

TEST(ReportPage, OfThePapersTestStaysBelowTenMegabytes) {
  const std::string page =
      Page(test::MakeUpStudy({.samples = 94'096, .channels = 18, .controllers = 4, .seeds = 1}));
  EXPECT_LT(page.size(), 10'000'000U);
  EXPECT_GT(page.size(), 3'000'000U);
}

}  // namespace
}  // namespace gauntlet::sim
