// The page in a real browser. Skipped where there is no chromium: it is too large a package to ask
// of everybody who builds.
#include "tests/report/browser.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "sim/report/html_text.h"
#include "sim/report/page_data.h"
#include "sim/report/report_page.h"
#include "tests/report/made_up_study.h"

namespace gauntlet::sim {
namespace {

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
  const get = (id) => document.getElementById(id);
  const press = (key, shiftKey = false) =>
    get("curves-plot").dispatchEvent(new KeyboardEvent("keydown", {key, shiftKey, bubbles: true}));
  window.addEventListener("load", () => {
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
    const video = document.querySelector("#video video");
    Object.defineProperty(video, "currentTime", {value: 1.75, writable: true});
    video.dispatchEvent(new Event("timeupdate"));
    seen.at_video = get("curves-readout").rows[0].cells[0].textContent;
    document.querySelector("#heat-map tbody tr:nth-child(2) button").click();
    seen.channel_of_heat_map = get("curves-channel").value;
    const metric = get("heat-metric");
    const cells = get("heat-map").textContent;
    metric.selectedIndex = metric.options.length - 1;
    metric.dispatchEvent(new Event("change"));
    seen.metric_switched = get("heat-map").textContent !== cells;
    document.querySelectorAll("#curves-readout input").forEach((box) => box.click());
    seen.points = document.querySelectorAll("#front-chart circle").length;
    seen.causes = document.querySelectorAll("#error-bars rect").length;
    seen.cause_rows = get("error-table").rows.length;
    const explain = document.querySelector(".explain");
    explain.click();
    seen.explained = !get(explain.getAttribute("aria-controls")).hidden;
    seen.wide = document.documentElement.scrollWidth - window.innerWidth;
    seen.problems = problems;
    document.documentElement.setAttribute("data-seen", encodeURIComponent(JSON.stringify(seen)));
  });
</script>)";

class BrowserTest : public testing::Test {
 protected:
  void SetUp() override {
    if (!test::HasBrowser()) GTEST_SKIP() << "chromium is not installed";
  }

  static nlohmann::json Use(const std::string& page, int width_px) {
    return test::UsePage(page, kUse, width_px);
  }

  static std::string Page(const test::MadeUpStudy& made) {
    const auto data = PageData(made, made.first_seed());
    return AssemblePage({.title = made.study.scenario.name,
                         .question = made.study.scenario.question,
                         .facts = "facts",
                         .verdict = "verdict",
                         .data = JsonForScript(data),
                         .resolved_scenario = "made_with:\n  gauntlet_version: \"1\"\n",
                         .video = {.exists = true, .motion_starts_s = 1.5}});
  }

  static void ExpectItWorks(const nlohmann::json& seen) {
    EXPECT_EQ(seen["problems"], nlohmann::json::array());
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
    EXPECT_EQ(seen["channel_of_heat_map"], "channel_1");
    EXPECT_EQ(seen["metric_switched"], true);
    EXPECT_EQ(seen["points"], 3);
    EXPECT_EQ(seen["causes"], 3 * TrackingErrorParts().size());
    EXPECT_EQ(seen["cause_rows"], 1 + TrackingErrorParts().size() + 1);  // names, causes, the whole
    EXPECT_EQ(seen["explained"], true);
    EXPECT_LE(seen["wide"], 0) << "the page must not scroll sideways";
  }
};

TEST_F(BrowserTest, ShowsCurvesAndSwitchesChannelsWithoutAConsoleError) {
  ExpectItWorks(Use(Page(test::MakeUpStudy({})), 1200));
}

TEST_F(BrowserTest, WorksOnAPhone) { ExpectItWorks(Use(Page(test::MakeUpStudy({})), 500)); }

TEST_F(BrowserTest, WorksWithFewerPointsThanSamples) {
  ExpectItWorks(Use(Page(test::MakeUpStudy({.samples = 130'000})), 1200));
}

}  // namespace
}  // namespace gauntlet::sim
