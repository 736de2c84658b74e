// The hand that moves in the page, in a real browser, held against the physics engine and the
// trace. Skipped where there is no chromium.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <memory>

#include "sim/answers/compare/decisive_second.h"
#include "sim/hand/posture.h"
#include "sim/show/pages/report_page.h"
#include "sim/study/study_run.h"
#include "tests/report/browser.h"
#include "tests/support/source_dir.h"

namespace gauntlet::sim {
namespace {

/// Runs last: reads back where the hands stand at some moments, and uses what a person uses.
constexpr const char* kUse = R"(<script>
  const wait = (ms) => new Promise((done) => setTimeout(done, ms));
  const leave = (seen) =>
    document.documentElement.setAttribute("data-seen", encodeURIComponent(JSON.stringify(seen)));
  window.addEventListener("unhandledrejection", (e) => leave({problems: [String(e.reason.stack)]}));
  window.addEventListener("load", async () => {
    const get = (id) => document.getElementById(id);
    const set = (id, value) => {
      get(id).value = value;
      for (const type of ["input", "change"]) get(id).dispatchEvent(new Event(type));
    };
    const view = get("replay").view;
    const seen = {webgl: view.picture.constructor.name, moments: []};
    const state = (hand) => ({
      angles: view.replay.joints.map((name, i) => hand.angleOf(i)),
      places: hand.bodies.map((body) => body.matrixWorld.toArray().slice(12, 15)),
    });
    const picture = () => { view.drawNow(); return view.canvas.toDataURL(); };
    seen.first_time = view.time;
    seen.decisive_second = view.data.decisive_second;
    view.play(true);
    view.goOn(1000);
    for (let i = 0; i < 40; ++i) view.goOn(1000 + 100 * i);
    seen.loops = view.time >= view.loop[0] && view.time <= view.loop[1];
    view.play(false);
    set("replay-hand", "0");
    set("replay-other", "1");
    for (const time of [0, 0.21, 0.399]) {
      set("replay-time", time);
      seen.moments.push({time: view.time, cursor: get("curves-readout").rows[0].cells[0].textContent,
        hand: state(view.hand), other: state(view.other), wearer: state(view.ghost),
        cables: view.replay.cables.map((cable) => view.hand.cableWay(cable)
          .reduce((sum, point, i, way) => sum + (i ? point.distanceTo(way[i - 1]) : 0), 0))});
    }
    const with_both = picture();
    seen.drawn = with_both.length;
    set("replay-other", "");
    const alone = picture();
    seen.other_is_seen = alone !== with_both;
    get("replay-ghost").click();
    seen.ghost_is_seen = picture() !== alone;
    const before = picture();
    view.canvas.dispatchEvent(new KeyboardEvent("keydown", {key: "ArrowLeft", bubbles: true}));
    seen.turns = picture() !== before;
    set("replay-time", 0.1);
    set("replay-speed", "0.25");
    get("replay-play").click();
    for (let i = 0; i < 1000 && view.time <= 0.1; ++i) await wait(20);
    seen.plays = view.time > 0.1;
    view.goOn(5000);
    const from = view.time;
    view.goOn(5040);
    seen.slow_motion = view.time - from;
    get("replay-play").click();
    const paused = view.time;
    await wait(200);
    seen.pauses = view.time === paused;
    get("curves-plot").dispatchEvent(new KeyboardEvent("keydown", {key: "ArrowRight", bubbles: true}));
    seen.follows = view.time > paused;
    seen.wide = document.documentElement.scrollWidth - window.innerWidth;
    seen.problems = problems;
    leave(seen);
  });
</script>)";

/// What a browser without WebGL does.
constexpr const char* kNoWebGl = R"(<script>
  const whole = HTMLCanvasElement.prototype.getContext;
  HTMLCanvasElement.prototype.getContext = function (kind, ...rest) {
    return kind.includes("webgl") ? null : whole.call(this, kind, ...rest);
  };
</script><title>)";

FinishedStudy RunSmallStudy() {
  Scenario scenario;
  scenario.name = "small";
  scenario.question = "Does the hand move?";
  scenario.glove.motion.settings = RandomMotionConfig{.duration_s = 0.4};
  scenario.controllers = {{.name = "raw", .config = {}}, {.name = "mean", .config = {}}};
  controller::FilterConfig mean;
  mean.settings = controller::MovingAverageConfig{.window = 60};
  scenario.controllers[1].config.filters = {mean};
  FinishedStudy finished;
  finished.study = PrepareStudy(std::move(scenario));
  finished.result = RunStudy(finished.study, {.seeds = 1, .jobs = 1});
  finished.summary = Summarise(finished.study, finished.result);
  return finished;
}

class ReplayTest : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    if (!test::HasBrowser()) return;
    finished_ = std::make_unique<FinishedStudy>(RunSmallStudy());
    page_ = ReportPage(*finished_, {});
  }
  static void TearDownTestSuite() { finished_.reset(); }
  void SetUp() override {
    if (!finished_) GTEST_SKIP() << "chromium is not installed";
  }

  using Data = std::unique_ptr<mjData, void (*)(mjData*)>;
  static Data MakeData() { return {mj_makeData(&finished_->study.hand->model()), mj_deleteData}; }

  /// What the page says of one hand against a row of angles [rad]: 0.005 deg is how fine a page is.
  static void ExpectHand(const nlohmann::json& seen, const Signal& angle_rad, Eigen::Index row,
                         mjData& data) {
    const HandModel& hand = *finished_->study.hand;
    std::vector<double> angles(angle_rad.cols());
    for (Eigen::Index i = 0; i < angle_rad.cols(); ++i) {
      angles[i] = angle_rad(row, i);
      EXPECT_NEAR(seen["angles"][i], angles[i] * kDegPerRad, 0.004) << hand.joint_names()[i];
    }
    SetPosture(hand, angles, std::vector<double>(hand.motor_names().size()), data);
    for (int body = 1; body < hand.model().nbody; ++body) {
      for (int axis = 0; axis < 3; ++axis) {
        EXPECT_NEAR(seen["places"][body][axis], data.xpos[3 * body + axis], 1e-4)
            << mj_id2name(&hand.model(), mjOBJ_BODY, body);
      }
    }
  }

  static inline std::unique_ptr<FinishedStudy> finished_;
  static inline std::string page_;
};

TEST_F(ReplayTest, StandsWhereThePhysicsEnginePutsTheTrace) {
  const auto seen = test::UsePage(page_, kUse, 1200);
  ASSERT_EQ(seen["problems"], nlohmann::json::array());
  EXPECT_EQ(seen["webgl"], "WebGlPicture");
  const Data data = MakeData();
  const StudyResult& result = finished_->result;
  ASSERT_EQ(seen["moments"].size(), 3u);
  for (const auto& moment : seen["moments"]) {
    const Eigen::Index row = std::lround(moment["time"].get<double>() * 1000.0);
    ExpectHand(moment["wearer"], result.first_reference_rad, row, *data);
    ExpectHand(moment["other"], result.first_traces[1].hand_angle_rad, row, *data);
    ExpectHand(moment["hand"], result.first_traces[0].hand_angle_rad, row, *data);
    for (int cable = 0; cable < finished_->study.hand->model().ntendon; ++cable) {
      EXPECT_NEAR(moment["cables"][cable], data->ten_length[cable], 2e-4)
          << mj_id2name(&finished_->study.hand->model(), mjOBJ_TENDON, cable);
    }
    EXPECT_EQ(moment["cursor"], fmt::format("at {:.3f} s, deg", moment["time"].get<double>()));
  }
  EXPECT_GT(seen["drawn"], 20'000) << "a picture that shows something is no short text";
  for (const char* what :
       {"other_is_seen", "ghost_is_seen", "turns", "plays", "pauses", "follows"}) {
    EXPECT_EQ(seen[what], true) << what;
  }
  EXPECT_NEAR(seen["slow_motion"], 0.25 * 0.04, 1e-9);
  const auto second = DecisiveSecondOf(*finished_);
  ASSERT_TRUE(second);
  EXPECT_NEAR(seen["first_time"], second->moment_s, 1e-9);
  EXPECT_NEAR(seen["decisive_second"][1], second->to_s, 1e-9);
  EXPECT_EQ(seen["loops"], true);
  EXPECT_LE(seen["wide"], 0);
}

TEST_F(ReplayTest, IsAFlatPictureWithoutWebGl) {
  std::string page = page_;
  page.replace(page.find("<title>"), 7, kNoWebGl);
  const auto seen = test::UsePage(page, kUse, 1200);
  ASSERT_EQ(seen["problems"], nlohmann::json::array());
  EXPECT_EQ(seen["webgl"], "FlatPicture");
  EXPECT_GT(seen["drawn"], 20'000);
  for (const char* what : {"other_is_seen", "ghost_is_seen", "turns"})
    EXPECT_EQ(seen[what], true) << what;
}

}  // namespace
}  // namespace gauntlet::sim
