// The page in a real browser. Skipped where there is no chromium: it is too large a package to ask
// of everybody who builds.
#include "tests/report/browser.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>
#include <numbers>
#include <random>
#include <sstream>

#include "sim/answers/compare/comparison_verdict.h"
#include "sim/base/json.h"
#include "sim/results/html_text.h"
#include "sim/show/pages/front_chart.h"
#include "sim/show/pages/page_data.h"
#include "sim/show/pages/report_page.h"
#include "sim/show/pages/score_table.h"
#include "tests/report/made_up_study.h"

namespace gauntlet::sim {
namespace {

/// Runs last: saves what the frequencies are made of.
constexpr const char* kSaveFrequencies = R"(<script>
  window.addEventListener("load", async () => {
    const seen = {problems, said: {}};
    for (const name of ["spectrum", "gain", "phase"]) {
      seen.said[name] = document.getElementById(`${name}-chart`).textContent;
      seen[name] = await saved(document.querySelector(`[title="Save as made_up.${name}.csv"]`));
    }
    leave(seen);
  });
</script>)";

/// Runs last: where the curves have a ground of their own, on the screen and as saved.
constexpr const char* kFindShade = R"(<script>
  window.addEventListener("load", async () => {
    const select = document.getElementById("curves-channel");
    const look = async (channel) => {
      select.value = channel;
      select.dispatchEvent(new Event("change"));
      await wait(50);
      const canvas = document.querySelector("#curves-plot canvas");
      const row = canvas.getContext("2d").getImageData(0, 3, canvas.width, 1).data;
      let shaded = 0;
      for (let i = 3; i < row.length; i += 4) shaded += row[i] === 255;
      const svg = await saved(document.querySelector('[title="Save as made_up.curves.svg"]'));
      return [shaded / canvas.width, svg.split('class="band"').length - 1];
    };
    leave({problems, note: document.getElementById("curves-note").textContent,
      first: await look("channel_0"), second: await look("channel_1")});
  });
</script>)";

/// Runs last: uses the page as a person does, and leaves what it saw in an attribute.
constexpr const char* kUse = R"(<script>
  const seen = {};
  const ink = () => {
    let dots = 0;
    for (const canvas of document.querySelectorAll("#curves-plot canvas")) {
      const {data} = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
      for (let i = 3; i < data.length; i += 4) dots += data[i] > 60;
    }
    return dots;
  };
  const picture = () => document.querySelector("#curves-plot canvas").toDataURL();
  const columns = () => [...document.querySelectorAll("#scores-table thead th")].slice(1)
    .map((th) => /raw|filter_\d/.exec(th.textContent)[0]);
  const get = (id) => document.getElementById(id);
  const press = (key, shiftKey = false) =>
    get("curves-plot").dispatchEvent(new KeyboardEvent("keydown", {key, shiftKey, bubbles: true}));
  window.addEventListener("load", async () => {
    seen.columns = columns();
    seen.channel = get("curves-channel").value;
    seen.ink = ink();
    const first = picture();
    get("curves-channel").value = "channel_0";
    get("curves-channel").dispatchEvent(new Event("change"));
    seen.channel_switched = picture() !== first;
    seen.chosen = document.querySelector("#heat-map tr.chosen").dataset.channel;
    const whole = picture();
    press("+");
    seen.zoomed = picture() !== whole;
    press("ArrowRight");
    seen.readout = get("curves-readout").rows[1].cells[1].textContent;
    press("0");
    seen.whole_again = picture() === whole;
    get("curves-view").value = "error";
    get("curves-view").dispatchEvent(new Event("change"));
    seen.error_of_wearer = new Set([...Array(20).keys()].map((i) => {
      press("ArrowRight");
      return get("curves-readout").rows[1].cells[1].textContent;
    }));
    seen.error_of_wearer = [...seen.error_of_wearer];
    seen.error_axis = document.querySelector("#curves-plot .dygraph-ylabel").textContent;
    get("curves-view").value = "angle";
    get("curves-view").dispatchEvent(new Event("change"));
    // The mouse does what the help says: a drag zooms, a double click shows all again.
    const until = async (holds) => {
      for (let i = 0; i < 100 && !holds(); ++i) await wait(50);
      return holds();
    };
    const all = picture();
    const canvas = [...document.querySelectorAll("#curves-plot canvas")][1];
    const box = canvas.getBoundingClientRect();
    const mouse = (type, share, to = canvas) => to.dispatchEvent(new MouseEvent(type, {bubbles: true,
      view: window, button: 0, clientX: box.left + share * box.width, clientY: box.top + 60,
      screenX: share * box.width, screenY: 60}));
    mouse("mousedown", 0.3);
    mouse("mousemove", 0.5, document);
    mouse("mousemove", 0.6, document);
    mouse("mouseup", 0.6, document);
    seen.drag_zooms = await until(() => picture() !== all);
    await wait(300);
    for (const type of ["mousedown", "mouseup", "mousedown", "mouseup", "dblclick"]) mouse(type, 0.5);
    seen.double_click_shows_all = await until(() => picture() === all);
    seen.address = location.hash;
    location.hash = "#channel=channel_2&view=error&t=0.5";
    await wait(100);
    seen.at_address = [get("curves-channel").value, get("curves-view").value,
      get("curves-readout").rows[0].cells[0].textContent];
    location.hash = "#scores";
    await wait(100);
    seen.part_of_page = get("curves-channel").value;
    get("curves-view").value = "angle";
    get("curves-view").dispatchEvent(new Event("change"));
    seen.saved = {};
    for (const button of document.querySelectorAll(".save button")) {
      const name = button.title.replace("Save as made_up.", "");
      await saved(button);
      seen.saved[name] = [files[0]?.type, files[0]?.text.slice(0, 60)];
    }
    document.querySelector("#scores-table .sort").click();
    seen.sorted = columns();
    get("scores-order").click();
    seen.order_of_verdict = columns();
    seen.seeds = [document.querySelectorAll("#seeds-chart circle").length,
      document.querySelectorAll("#seeds-chart .seed").length];
    // At the far end of a wide table, the names and the first controller are in sight.
    const scroll = get("scores-table").parentElement;
    scroll.scrollLeft = 10000;
    seen.in_sight = [...get("scores-table").rows[1].cells].slice(0, 2).map((cell) => {
      const [inner, outer] = [cell.getBoundingClientRect(), scroll.getBoundingClientRect()];
      return inner.left >= outer.left - 1 && inner.right <= outer.right + 1;
    });
    const video = document.querySelector("#video video");
    Object.defineProperty(video, "currentTime", {value: 1.75, writable: true});
    video.dispatchEvent(new Event("seeked"));
    seen.at_video = get("curves-readout").rows[0].cells[0].textContent;
    video.currentTime = 4.0;  // in its slow motion
    video.dispatchEvent(new Event("seeked"));
    seen.at_slow_motion = get("curves-readout").rows[0].cells[0].textContent;
    press("ArrowRight");
    seen.video_follows = video.currentTime;
    document.querySelector("#heat-map tbody tr:nth-child(2) button").click();
    seen.channel_of_heat_map = get("curves-channel").value;
    const metric = get("heat-metric");
    const cells = get("heat-map").textContent;
    metric.selectedIndex = metric.options.length - 1;
    metric.dispatchEvent(new Event("change"));
    seen.metric_switched = get("heat-map").textContent !== cells;
    document.querySelectorAll("#curves-readout input").forEach((box) => box.click());
    seen.points = document.querySelectorAll("#front-chart .wide circle").length;
    seen.causes = document.querySelectorAll("#error-bars rect").length;
    seen.cause_rows = get("error-table").rows.length;
    seen.switched = [...get("switched-table").rows].map((row) => row.cells.length);
    const explain = document.querySelector(".explain");
    explain.click();
    seen.explained = !get(explain.getAttribute("aria-controls")).hidden;
    seen.wide = document.documentElement.scrollWidth - window.innerWidth;
    seen.problems = problems;
    leave(seen);
  });
</script>)";

class BrowserTest : public testing::Test {
 protected:
  void SetUp() override {
    if (!test::HasBrowser()) GTEST_SKIP() << "chromium is not installed";
  }

  static nlohmann::json Use(const std::string& page, int width_px, const char* script = kUse) {
    return test::UsePage(page, std::string(test::kSaved) + script, width_px);
  }

  static std::string Page(const test::MadeUpStudy& made) {
    const auto data = PageData(made, made.first_seed());
    return AssemblePage(
        {.head = {.title = made.study.scenario.name,
                  .question = made.study.scenario.question,
                  .answer = "verdict"},
         .facts = "facts",
         .front = ControllersFront(made.summary),
         .data = JsonForScript(data),
         .resolved_scenario = "made_with:\n  gauntlet_version: \"1\"\n",
         .video = {.exists = true, .stretches = {{1.5, 0.0, 1.5, 1.0}, {3.0, 0.2, 0.7, 0.25}}}});
  }

  static void ExpectItIsSaved(const nlohmann::json& saved) {
    for (const char* name : {"error", "front", "seeds", "curves"}) {
      const std::string file = name;
      ASSERT_TRUE(saved.contains(file + ".svg")) << file;
      EXPECT_THAT(saved[file + ".svg"][1].get<std::string>(), testing::StartsWith("<svg")) << file;
      EXPECT_EQ(saved[file + ".png"][0], "image/png") << file;
      EXPECT_EQ(saved[file + ".csv"][0], "text/csv") << file;
    }
    EXPECT_THAT(saved["curves.csv"][1].get<std::string>(),
                testing::StartsWith("time_s,wearer_deg,glove_deg,raw_hand_deg"));
    EXPECT_THAT(saved["scores.csv"][1].get<std::string>(), testing::StartsWith("score,"));
    EXPECT_THAT(saved["latency.csv"][1].get<std::string>(),
                testing::StartsWith("stage_ms,filter_2,filter_1,raw\nfilter,5,4,3\n"));
    EXPECT_THAT(saved["channels.csv"][1].get<std::string>(),
                testing::StartsWith("tracking_rmse_deg,"));
  }

  static void ExpectItWorks(const nlohmann::json& seen) {
    ASSERT_EQ(seen["problems"], nlohmann::json::array());
    EXPECT_EQ(seen["channel"], "channel_2");  // the one that the scenario names
    EXPECT_GT(seen["ink"], 1000);
    EXPECT_EQ(seen["channel_switched"], true);
    EXPECT_EQ(seen["chosen"], "channel_0");
    EXPECT_EQ(seen["zoomed"], true);
    EXPECT_NE(seen["readout"], "");
    EXPECT_EQ(seen["whole_again"], true);
    EXPECT_EQ(seen["error_of_wearer"], nlohmann::json::array({"0.00"}));
    EXPECT_EQ(seen["error_axis"], "angle less the wearer's, deg");
    EXPECT_THAT(seen["at_video"].get<std::string>(), testing::StartsWith("at 0.25"));
    EXPECT_THAT(seen["at_slow_motion"].get<std::string>(), testing::StartsWith("at 0.45"));
    EXPECT_GT(seen["video_follows"], 1.95);  // a step further, where the motion is at real speed
    EXPECT_LT(seen["video_follows"], 3.0);
    EXPECT_EQ(seen["drag_zooms"], true);
    EXPECT_EQ(seen["double_click_shows_all"], true);
    EXPECT_THAT(seen["address"].get<std::string>(), testing::StartsWith("#channel=channel_0"));
    EXPECT_EQ(seen["at_address"][0], "channel_2");
    EXPECT_EQ(seen["at_address"][1], "error");
    EXPECT_THAT(seen["at_address"][2].get<std::string>(), testing::StartsWith("at 0.5"));
    EXPECT_EQ(seen["part_of_page"], "channel_2");
    EXPECT_EQ(seen["in_sight"], nlohmann::json::array({true, true}));
    EXPECT_EQ(seen["seeds"], nlohmann::json::array({3 * 5, 5}));
    ExpectItIsSaved(seen["saved"]);
    EXPECT_EQ(seen["channel_of_heat_map"], "channel_1");
    EXPECT_EQ(seen["metric_switched"], true);
    EXPECT_EQ(seen["points"], 3);
    EXPECT_EQ(seen["causes"], 3 * TrackingErrorParts().size());
    EXPECT_EQ(seen["cause_rows"], 1 + TrackingErrorParts().size() + 1);  // names, causes, the whole
    EXPECT_EQ(seen["switched"], std::vector(1 + 1 + kSwitchedCauseCount, 1 + 3));
    EXPECT_EQ(seen["explained"], true);
    EXPECT_LE(seen["wide"], 0) << "the page must not scroll sideways";
  }
};

TEST_F(BrowserTest, ShowsCurvesAndSwitchesChannelsWithoutAConsoleError) {
  ExpectItWorks(Use(Page(test::MakeUpStudy({})), 1200));
}

TEST_F(BrowserTest, ColumnsStandInTheOrderOfTheVerdictOrOfAScore) {
  test::MadeUpStudy made = test::MakeUpStudy({});
  const std::size_t tracking = MetricIndex("tracking_rmse_deg");
  const double rmse[] = {5.0, 3.0, 1.0};
  for (std::size_t c = 0; c < 3; ++c) {
    for (SeedOutcome& seed : made.result.seeds) {
      seed.controllers[c].scores.summary[tracking] = rmse[c] + 0.01 * seed.seed;
      seed.controllers[c].scores.summary[MetricIndex("jitter_rms_deg")] = 1.0 + rmse[c];
    }
  }
  made.summary = Summarise(made.study, made.result);
  EXPECT_EQ(made.summary.answer.order, (std::vector<std::size_t>{2, 1, 0}));
  const auto seen = Use(Page(made), 1200);
  EXPECT_EQ(seen["columns"], (std::vector<std::string>{"filter_2", "filter_1", "raw"}));
  EXPECT_EQ(seen["sorted"], seen["columns"]);  // by tracking
  EXPECT_EQ(seen["order_of_verdict"], seen["columns"]);
}

TEST_F(BrowserTest, WhatDoesNotCountStandsOnGrey) {
  test::MadeUpStudy made = test::MakeUpStudy({});
  made.counted.emplace();
  made.counted->joints = {{{0, 500}, {900, 1500}}, {{0, 1500}}, {}};
  const auto seen = Use(Page(made), 1200, kFindShade);
  ASSERT_EQ(seen["problems"], nlohmann::json::array());
  EXPECT_THAT(seen["note"].get<std::string>(), testing::HasSubstr("Grey: not scored"));
  EXPECT_NEAR(seen["first"][0], 400.0 / 1500.0, 0.03);
  EXPECT_EQ(seen["first"][1], 1);
  EXPECT_EQ(seen["second"], nlohmann::json::array({0, 0}));
}

/// Wrong: a line for each controller, all alike.
TEST_F(BrowserTest, RejectedSamplesOfAllControllersAreOneLine) {
  test::MadeUpStudy made = test::MakeUpStudy({});
  for (std::size_t c = 0; c < 3; ++c) {
    made.result.seeds[0].controllers[c].untrusted_samples[0] = 16 + static_cast<int>(c);
  }
  const auto seen = Use(Page(made), 1200, R"(<script>
    leave({lines: [...document.querySelectorAll("#problems li")].map((line) => line.textContent)});
  </script>)");
  ASSERT_EQ(seen["lines"].size(), 1U);
  EXPECT_THAT(seen["lines"][0].get<std::string>(),
              testing::StartsWith("All controllers: 16 to 18 glove samples were rejected"));
}

/// A table that was saved: rows of numbers.
std::vector<std::vector<double>> Numbers(const std::string& csv) {
  std::vector<std::vector<double>> rows;
  std::istringstream lines(csv.substr(csv.find('\n') + 1));
  for (std::string line; std::getline(lines, line);) {
    std::istringstream fields(line + ",");  // the last field may be empty
    std::vector<double>& row = rows.emplace_back();
    for (std::string field; std::getline(fields, field, ',');) {
      row.push_back(field.empty() ? std::numeric_limits<double>::quiet_NaN() : std::stod(field));
    }
  }
  return rows;
}

TEST_F(BrowserTest, FrequenciesAreThoseOfTheSignals) {
  // A sine of 2 Hz; hands that are late by 60 and 70 ms, the later one moves less; one that does
  // not follow. All tremble by white noise.
  constexpr int kSamples = 20'000;
  constexpr double kFrequency_hz = 2.0;
  constexpr double kGain[] = {1.0, 0.9, 0.0};
  const double noise_rad[] = {0.004, 0.002, 0.001};
  test::MadeUpStudy made = test::MakeUpStudy({.samples = kSamples, .channels = 1});
  const auto angle = [](double t, double gain) {
    return 0.6 + 0.3 * gain * std::sin(2.0 * std::numbers::pi * kFrequency_hz * t);
  };
  Signal wearer(kSamples, 1);
  for (int k = 0; k < kSamples; ++k) wearer(k, 0) = angle(k / 1000.0, 1.0);
  GloveSignal glove = *made.result.first_glove;
  glove.true_angle_rad = wearer;
  made.result.first_glove = std::make_shared<const GloveSignal>(std::move(glove));
  std::mt19937 random(1);
  for (int c = 0; c < 3; ++c) {
    std::normal_distribution<double> noise(0.0, noise_rad[c]);
    for (int k = 0; k < kSamples; ++k) {
      made.hand_rad[c](k, 0) = angle(k / 1000.0 - 0.06 - 0.01 * c, kGain[c]) + noise(random);
    }
  }
  const auto seen = Use(Page(made), 1200, kSaveFrequencies);
  ASSERT_EQ(seen["problems"], nlohmann::json::array());
  const auto spectrum = Numbers(seen["spectrum"]);
  const auto gain = Numbers(seen["gain"]);
  const auto phase = Numbers(seen["phase"]);
  ASSERT_GT(spectrum.size(), 40u);
  for (int c = 0; c < 3; ++c) {
    double power = 0.0;
    int count = 0;
    for (const auto& row : spectrum) {
      if (row[0] < 10.0) continue;
      power += row[1 + c] * row[1 + c];
      ++count;
    }
    // White noise has its power spread up to half of 1 kHz.
    const double density = noise_rad[c] * 180.0 / std::numbers::pi * std::sqrt(2.0 / 1000.0);
    EXPECT_NEAR(std::sqrt(power / count), density, 0.1 * density);
    const auto at = [&](const std::vector<std::vector<double>>& rows) {
      return *std::ranges::min_element(
          rows, {}, [](const auto& row) { return std::abs(row[0] - kFrequency_hz); });
    };
    if (kGain[c] == 0.0) {
      for (const auto& row : gain) EXPECT_TRUE(std::isnan(row[1 + c])) << row[0];
      continue;
    }
    EXPECT_NEAR(at(gain)[1 + c], kGain[c], 0.01);
    EXPECT_NEAR(at(phase)[1 + c], -360.0 * kFrequency_hz * (0.06 + 0.01 * c), 1.0);
  }
}

/// Of one channel over 20 s: a wearer's slow sine, a hand that follows at once and trembles by
/// white noise of 0.002 rad; from 8 to 9 s both stand still, as where a gap of a recording is
/// filled, and the hand jumps at its ends.
test::MadeUpStudy StudyWithAGap() {
  constexpr int kSamples = 20'000;
  test::MadeUpStudy made =
      test::MakeUpStudy({.samples = kSamples, .channels = 1, .controllers = 1});
  std::mt19937 random(1);
  std::normal_distribution<double> noise(0.0, 0.002);
  GloveSignal glove = *made.result.first_glove;
  for (int k = 0; k < kSamples; ++k) {
    const bool gap = k >= 8000 && k < 9000;
    const double angle = 0.6 + 0.3 * std::sin(2.0 * std::numbers::pi * 0.7 * k / 1000.0);
    glove.true_angle_rad(k, 0) = gap ? 0.1 : angle;
    made.hand_rad[0](k, 0) = gap ? 1.5 : angle + noise(random);
  }
  made.result.first_glove = std::make_shared<const GloveSignal>(std::move(glove));
  return made;
}

TEST_F(BrowserTest, FrequenciesLeaveOutWhatDoesNotCount) {
  test::MadeUpStudy made = StudyWithAGap();
  made.counted.emplace();
  made.counted->joints = {{{0, 8000}, {9000, 20'000}}};
  const auto seen = Use(Page(made), 1200, kSaveFrequencies);
  ASSERT_EQ(seen["problems"], nlohmann::json::array());
  double power = 0.0;
  int count = 0;
  for (const auto& row : Numbers(seen["spectrum"])) {
    if (row[0] < 10.0) continue;
    power += row[1] * row[1];
    ++count;
  }
  ASSERT_GT(count, 40);
  const double density = 0.002 * 180.0 / std::numbers::pi * std::sqrt(2.0 / 1000.0);
  EXPECT_NEAR(std::sqrt(power / count), density, 0.1 * density);
  const auto gain = Numbers(seen["gain"]);
  const auto sine = std::ranges::min_element(gain, {}, [](const auto& row) {
    return std::abs(row[0] - 0.7);  // Hz
  });
  EXPECT_NEAR((*sine)[1], 1.0, 0.01);
}

TEST_F(BrowserTest, SaysWhereTooLittleCountsForFrequencies) {
  test::MadeUpStudy made = StudyWithAGap();
  made.counted.emplace();
  made.counted->joints = {{{0, 1500}, {9000, 10'500}}};
  const auto seen = Use(Page(made), 1200, kSaveFrequencies);
  ASSERT_EQ(seen["problems"], nlohmann::json::array());
  EXPECT_THAT(seen["said"]["spectrum"].get<std::string>(),
              testing::Not(testing::HasSubstr("Not known")));  // its windows are of 1 s
  EXPECT_FALSE(std::isnan(Numbers(seen["spectrum"]).front()[1]));
  EXPECT_EQ(seen["said"]["gain"], "Not known: fewer than 2 windows of 2.05 s in what counts.");
  EXPECT_EQ(seen["said"]["phase"], seen["said"]["gain"]);
  EXPECT_TRUE(std::isnan(Numbers(seen["gain"]).front()[1]));
}

// What a browser without scripts shows.
TEST(ReportPage, HasVerdictScoresTradeOffAndVideoWithoutScripts) {
  const test::MadeUpStudy made = test::MakeUpStudy({});
  std::string page = AssemblePage(
      {.head = {.title = "made_up", .question = "Is the page whole?", .answer = "Use filter_1."},
       .facts = "facts",
       .numbers = HtmlOf(ShownText(made)),
       .answer = HtmlOf(AnswerText(made)),
       .front = ControllersFront(made.summary),
       .data = "{}",
       .resolved_scenario = "",
       .video = {.exists = true}});
  for (std::size_t begin; (begin = page.find("<script")) != std::string::npos;) {
    page.erase(begin, page.find("</script>", begin) + 9 - begin);
  }
  EXPECT_THAT(page, testing::HasSubstr(">Use filter_1.</p>"));
  const std::string table = page.substr(page.find("<noscript>"));
  for (const char* name : {"raw", "filter_1", "filter_2"}) {
    EXPECT_THAT(table.substr(0, table.find("</noscript>")),
                testing::HasSubstr(std::string("<th scope=\"row\">") + name));
  }
  EXPECT_THAT(page, testing::HasSubstr("class=\"wide\""));
  EXPECT_THAT(page, testing::HasSubstr("<video controls"));
}

TEST_F(BrowserTest, KeepsTheBestOfSixInSight) {
  for (const int width_px : {500, 768, 1920}) {
    const auto seen = Use(Page(test::MakeUpStudy({.controllers = 6})), width_px);
    EXPECT_EQ(seen["in_sight"], nlohmann::json::array({true, true})) << width_px;
    EXPECT_LE(seen["wide"], 0) << width_px;
    EXPECT_EQ(seen["problems"], nlohmann::json::array());
  }
}

TEST_F(BrowserTest, HasFourPagesOnPaper) {
  const test::MadeUpStudy made = test::MakeUpStudy({.channels = 18, .controllers = 5});
  EXPECT_LE(test::PagesOnPaper(Page(made)), 4);
}

TEST_F(BrowserTest, WorksOnAPhone) { ExpectItWorks(Use(Page(test::MakeUpStudy({})), 500)); }

TEST_F(BrowserTest, WorksWithFewerPointsThanSamples) {
  ExpectItWorks(Use(Page(test::MakeUpStudy({.samples = 130'000})), 1200));
}

}  // namespace
}  // namespace gauntlet::sim
