// Pages of many settings: what stands there without scripts, what scripts add, and how large it
// gets.
#include "sim/show/pages/cells_page.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <string>
#include <vector>

#include "controller/number.h"
#include "sim/answers/sweep/sweep_tables.h"
#include "sim/answers/tune/tune_tables.h"
#include "sim/show/pages/cells_chart.h"
#include "sim/show/pages/interval_chart.h"
#include "sim/show/pages/pages.h"
#include "tests/report/browser.h"

namespace gauntlet::sim {
namespace {

using testing::AllOf;
using testing::HasSubstr;

TunePlan MadeUpPlan() {
  TunePlan plan;
  plan.scenario.file = "made_up.yaml";
  plan.controller = "it";
  plan.free = {ParseFree("filter.min_cutoff_hz=0.1:10:log", "it"),
               ParseFree("filter.beta=0:1", "it")};
  plan.minimise = MetricIndex("tracking_rmse_deg");
  return plan;
}

/// Settings on a spiral over both ranges; the error is the distance to the middle.
TuneResult MadeUpResult(const TunePlan& plan, int count) {
  TuneResult result;
  result.metrics = {plan.minimise, MetricIndex("delay_ms"), MetricIndex("jitter_rms_deg")};
  for (int i = 0; i < count; ++i) {
    const double x = std::fmod(0.5 + 0.754877666 * i, 1.0);  // low discrepancy
    const double y = std::fmod(0.5 + 0.569840296 * i, 1.0);
    TunedSetting& setting = result.tried.emplace_back();
    setting.values = {plan.free[0].ValueAt(x), plan.free[1].ValueAt(y)};
    for (const double score : {1.0 + std::hypot(x - 0.5, y - 0.5), 50.0 + 100.0 * x, 1.0 - x}) {
      setting.scores.push_back({.mean = score});
    }
  }
  result.before.scores = result.verdict.scores = result.tried.front().scores;
  result.equal = {{"0.5", "<b>"}, {"0.1", "0.9"}};
  return result;
}

std::size_t Count(const std::string& text, const std::string& part) {
  std::size_t count = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) {
    ++count;
  }
  return count;
}

TEST(CellsPage, StandsThereWithoutScripts) {
  const TunePlan plan = MadeUpPlan();
  const std::string page = TunePage(plan, MadeUpResult(plan, 40));
  const std::string body =
      page.substr(page.find("<body>"), page.find("<script") - page.find("<body>"));
  EXPECT_THAT(body, AllOf(HasSubstr("<td>0.5 to &lt;b&gt;</td>"), HasSubstr("it of made_up"),
                          HasSubstr("min_cutoff_hz: 1\n"),
                          HasSubstr("gauntlet compare made_up.yaml --seeds 8 --controllers it")));
  EXPECT_EQ(Count(body, "<path data-point"), 40u);
  // In jitter over delay, and over both settings: a map of 144 places would show what was not
  // tried.
  EXPECT_EQ(Count(body, "<circle data-point"), 2u * 40u);
  EXPECT_EQ(Count(body, "class=\"heat-map scatter\""), 1u);
  EXPECT_EQ(Count(body, "class=\"heat-map\""), 0u);
  EXPECT_EQ(Count(page, "http://") + Count(page, "https://"), Count(page, "http://www.w3.org/"));
}

/// The colour is that of the limit, whatever the largest value. Wrong: one far value makes all
/// others pale.
TEST(HeatMap, HasItsLimitInTheMiddleOfItsColours) {
  const std::string svg = HeatMapSvg({.x_name = "episode",
                                      .y_name = "part",
                                      .score = "offset [deg]",
                                      .x_labels = {"0", "1", "2", "3"},
                                      .y_labels = {"wrist"},
                                      .best = {0.1, 2.5, 900.0, controller::kNaN},
                                      .points = std::vector(4, kNoPoint),
                                      .scale = LimitScale{.times_limit = {0.0, 1.25, 450.0, -1.0},
                                                          .at_zero = "0",
                                                          .at_limit = "5 % of motion",
                                                          .above = "10 % or more"}});
  const std::string cells = svg.substr(svg.find("wrist"));
  EXPECT_THAT(cells, AllOf(HasSubstr("--share: 0%"), HasSubstr("--share: 70%"),
                           HasSubstr("--share: 100%")));
  EXPECT_EQ(Count(cells, "--share"), 3u);
  EXPECT_THAT(svg, AllOf(HasSubstr(">5 % of motion<"), HasSubstr(">10 % or more<")));
}

TEST(CellsPage, BeginsWithTheAnswerOfTheTerminalAndItsNumbers) {
  const TunePlan plan = MadeUpPlan();
  const TuneResult result = MadeUpResult(plan, 40);
  const std::string page = TunePage(plan, result);
  const std::string head =
      page.substr(page.find("<header>"), page.find("</header>") - page.find("<header>"));
  const Verdict verdict = VerdictOf(plan, result);
  EXPECT_THAT(head, HasSubstr("<p class=\"headline\">" + verdict.Headline() + "</p>"));
  EXPECT_TRUE(verdict.Answer().front().starts_with(verdict.headline)) << verdict.headline;
  EXPECT_THAT(head, AllOf(HasSubstr("<span>tracking error</span>"), HasSubstr("<span>delay</span>"),
                          HasSubstr("<span>jitter</span>"), HasSubstr("before ")));
  EXPECT_EQ(Count(head, "<li"), 3u);
}

TEST(CellsPage, StaysSmallHoweverManySettingsThereAre) {
  const TunePlan plan = MadeUpPlan();
  const std::string page = TunePage(plan, MadeUpResult(plan, 30'000));
  EXPECT_LT(page.size(), 3'000'000u);
  EXPECT_GT(Count(page, "<path data-point"), kPagePoints / 2);
  EXPECT_LE(Count(page, "<path data-point"), kPagePoints);
  EXPECT_THAT(page, HasSubstr("of 30000 settings"));
  EXPECT_THAT(page,
              HasSubstr("<p class=\"note\" id=\"point-name\">try 0, the answer"));  // the middle
  EXPECT_EQ(Count(page, "class=\"cell\""), 12u * 12u);
}

TEST(CellsPage, BeginsWithTheAnswerHoweverManyHaveLessError) {
  const TunePlan plan = MadeUpPlan();
  TuneResult result = MadeUpResult(plan, 30'000);
  result.chosen = 23'456;
  ASSERT_GT(result.tried[result.chosen].scores.front().mean, 1.2);
  const std::string page = TunePage(plan, result);
  EXPECT_THAT(page, HasSubstr("id=\"point-name\">try 23456, the answer<"));
  EXPECT_THAT(page, HasSubstr("beta: " + result.tried[result.chosen].values[1] + "\n"));
  EXPECT_EQ(Count(page, ", the answer<"), 1u);
}

TEST(CellsPage, WritesSettingsAsAScenarioHasThem) {
  EXPECT_EQ(SettingsYaml({"controllers.it.filter.q=0.1", "event.delay_ms=25",
                          "controllers.it.filter.r=[1, 2]", "controllers.it.filter.0.q=3"}),
            "controllers:\n  it:\n    filter:\n      q: 0.1\n      r: [1, 2]\n"
            "event:\n  delay_ms: 25\n"
            "# --set controllers.it.filter.0.q=3\n");
}

TEST(Response, SaysWhereAControllerIsBetterAndDrawsEachOne) {
  SweepPlan plan;
  plan.best_by = MetricIndex("tracking_rmse_deg");
  plan.file.axes.emplace_back().key = "glove.motion.frequency_hz";
  Response response;
  response.values = {0.5, 1.0, 2.0, 4.0, 8.0};
  response.texts = {"0.5", "1", "2", "4", "8"};
  response.controllers = {"raw", "<b>"};
  response.metrics = {plan.best_by};
  response.comparisons = 5;
  response.verdicts = {{.controller = "<b>",
                        .judgements = {Judgement::kEqual, Judgement::kBetter, Judgement::kBetter,
                                       Judgement::kWorse, Judgement::kNone}}};
  for (int v = 0; v < 5; ++v) {
    const MeanInterval some{.mean = 2.0 + v, .low = 1.5 + v, .high = 2.5 + v};
    response.scores.push_back({{some}, {v < 4 ? some : MeanInterval{}}});
  }
  EXPECT_EQ(ResponseText(plan, response),
            "<b> against raw, by frequency_hz: better at 1 to 2; equivalent at 0.5; worse at 4.\n"
            "In tracking error, paired by seed, simultaneous 95 % (5 pairs, Bonferroni).");

  const std::string svg = ResponseSvg(response, 0, "frequency_hz");
  EXPECT_EQ(Count(svg, "class=\"curve\""), 2u);
  EXPECT_EQ(Count(svg, "class=\"interval\""), 2u);
  EXPECT_EQ(Count(svg, "<title>"), 9u);  // the last one has no score
  EXPECT_EQ(Count(svg, "<b>") + Count(svg, "nan"), 0u);
  EXPECT_THAT(svg, HasSubstr("<title>&lt;b&gt;, frequency_hz 4: 5.00±0.50</title>"));
}

/// Runs last: uses the page as a person does.
constexpr const char* kUse = R"(<script>
  const seen = {};
  const get = (id) => document.getElementById(id);
  window.addEventListener("load", async () => {
    seen.lines = document.querySelectorAll(".parallel path").length;
    seen.first = get("point-name").textContent;
    const circle = document.querySelector(".front circle[data-point='7']");
    circle.dispatchEvent(new MouseEvent("click", {bubbles: true}));
    seen.clicked = get("point-choice").value;
    seen.yaml = get("point-yaml").textContent;
    seen.scores = get("point-scores").children.length;
    const place = document.querySelector(".brush-place[data-axis='0']");
    const box = place.getBoundingClientRect();
    place.setPointerCapture = () => {};
    const drag = (type, share) => place.dispatchEvent(new PointerEvent(type, {bubbles: true,
      clientX: box.left + box.width / 2, clientY: box.bottom - share * box.height}));
    drag("pointerdown", 0.5);
    drag("pointermove", 1);
    drag("pointerup", 1);
    seen.brushed = get("brushed").textContent;
    seen.off = document.querySelectorAll(".parallel path.off").length;
    seen.circles_off = document.querySelectorAll(".front circle.off").length;
    get("brush-none").click();
    seen.all_again = document.querySelectorAll(".off").length;
    seen.wide = document.documentElement.scrollWidth - window.innerWidth;
    seen.saved = {};
    for (const button of document.querySelectorAll(".save button")) {
      seen.saved[button.title] = (await saved(button))?.slice(0, 40);
    }
    seen.problems = problems;
    leave(seen);
  });
</script>)";

TEST(CellsPage, BrushesAndShowsWhatIsClicked) {
  if (!test::HasBrowser()) GTEST_SKIP() << "chromium is not installed";
  const TunePlan plan = MadeUpPlan();
  const TuneResult result = MadeUpResult(plan, 40);
  int upper = 0;
  for (const TunedSetting& setting : result.tried) upper += std::stod(setting.values[0]) >= 1.0;
  const nlohmann::json seen =
      test::UsePage(TunePage(plan, result), std::string(test::kSaved) + kUse, 500);
  EXPECT_EQ(seen["problems"], nlohmann::json::array());
  EXPECT_EQ(seen["lines"], 40);
  EXPECT_EQ(seen["first"], "try 0, the answer");
  EXPECT_EQ(seen["clicked"], "7");
  EXPECT_THAT(seen["yaml"].get<std::string>(), HasSubstr("beta: "));
  EXPECT_EQ(seen["scores"], 2 * 3);  // names and values
  EXPECT_EQ(seen["brushed"], std::to_string(upper) + " of 40 settings");
  EXPECT_EQ(seen["off"], 40 - upper);
  EXPECT_EQ(seen["circles_off"], 40 - upper);
  EXPECT_EQ(seen["all_again"], 0);
  EXPECT_LE(seen["wide"], 0) << "the page must not scroll sideways";
  const auto saved = seen["saved"].get<std::map<std::string, std::string>>();
  for (const std::string name : {"heat-map", "parallel", "front"}) {
    const std::string file = "Save as it_of_made_up." + name;
    EXPECT_THAT(saved.at(file + ".svg"), testing::StartsWith("<svg"));
    EXPECT_NE(saved.at(file + ".png"), "");
  }
}

}  // namespace
}  // namespace gauntlet::sim
