// A hand of another kind, tests/support/three_joint_hand.xml, through the program: three joints,
// two motors, springs in place of extensor cables, a linkage, and a glove whose channels have other
// names than the joints.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/support/program.h"
#include "tests/support/source_dir.h"
#include "tests/support/working_folder.h"

namespace gauntlet::test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using Json = nlohmann::json;

const std::string kThreeJoints = SourceDir() + "/tests/support/three_joint_hand.yaml";

/// Runs first in the page: whatever goes wrong is kept.
constexpr const char* kListen = R"(<script>
  window.problems = [];
  window.addEventListener("error", (e) => problems.push(String(e.message)), true);
</script>)";

/// Runs last: shows every joint with every kind of curve, and says what there was.
constexpr const char* kUse = R"(<script>
  const ink = () => {
    let dots = 0;
    for (const canvas of document.querySelectorAll("#curves-plot canvas")) {
      const {data} = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
      for (let i = 3; i < data.length; i += 4) dots += data[i] > 60;
    }
    return dots;
  };
  window.addEventListener("load", () => {
    const seen = {inks: {}};
    const choice = document.getElementById("curves-channel");
    document.querySelectorAll("#curves-readout input").forEach((box) => {
      if (!box.checked) box.click();
    });
    for (const {value} of [...choice.options]) {
      choice.value = value;
      choice.dispatchEvent(new Event("change"));
      seen.inks[value] = ink();
    }
    seen.problems = problems;
    document.title = "seen " + JSON.stringify(seen) + " end";
  });
</script>)";

class OtherHandTest : public testing::Test {
 protected:
  ProgramResult Gauntlet(std::vector<std::string> arguments) {
    return folder_.Run(std::move(arguments));
  }
  std::string ReadFile(const std::string& name) const { return folder_.Read("out/" + name); }
  Json Scores() const { return Json::parse(ReadFile("scores.json")); }
  /// What the page of the run shows.
  Json PageData() const {
    const std::string page = ReadFile("report.html");
    const std::string mark = "<script type=\"application/json\" id=\"data\">";
    const std::size_t begin = page.find(mark) + mark.size();
    return Json::parse(page.substr(begin, page.find("</script>", begin) - begin));
  }
  Json UsePage() const {
    std::string page = ReadFile("report.html");
    const std::size_t policy = page.find("<meta http-equiv=\"Content-Security-Policy\"");
    page.erase(policy, page.find('>', policy) - policy + 1);
    page.insert(page.find("<title>"), kListen);
    page.insert(page.rfind("</body>"), kUse);
    const fs::path file = folder_.path() / "out" / "used.html";
    std::ofstream(file) << page;
    const ProgramResult result = RunProgram(
        {"chromium", "--headless", "--no-sandbox", "--disable-gpu", "--no-first-run",
         "--disable-dev-shm-usage", "--user-data-dir=" + (folder_.path() / "profile").string(),
         "--virtual-time-budget=4000", "--dump-dom", "file://" + file.string()});
    const std::size_t begin = result.standard_output.find("<title>seen ");
    const std::size_t end = result.standard_output.find(" end</title>");
    if (begin == std::string::npos || end == std::string::npos) {
      ADD_FAILURE() << "the page did not run:\n" << result.standard_error;
      return {};
    }
    return Json::parse(result.standard_output.substr(begin + 12, end - begin - 12));
  }

  WorkingFolder folder_{GAUNTLET_PROGRAM};
};

TEST_F(OtherHandTest, HasScoresPerJointMotorAndCable) {
  const ProgramResult result = Gauntlet({"run", kThreeJoints, "--out", "out"});
  ASSERT_EQ(result.exit_code, 0) << result.standard_error;
  EXPECT_THAT(result.standard_output, HasSubstr("3 of 3 joints"));
  const Json controller = Scores()["controllers"][0];
  const Json& parts = controller["channels"];
  for (const char* joint : {"base", "middle", "tip"}) {
    ASSERT_TRUE(parts[joint]["tracking_rmse_deg"].is_number()) << joint;
    EXPECT_LT(parts[joint]["tracking_rmse_deg"], 5.0) << joint;
    EXPECT_TRUE(parts[joint]["jitter_rms_deg"].is_number()) << joint;
  }
  for (const char* motor : {"base", "tip"}) {
    EXPECT_TRUE(parts[motor]["command_reversals_per_s"].is_number()) << motor;
    EXPECT_TRUE(parts[motor]["motor_speed_rms_deg_s"].is_number()) << motor;
  }
  EXPECT_FALSE(parts["middle"].contains("command_reversals_per_s"));  // it has no motor
  for (const char* cable : {"base_flexor", "tip_flexor"}) {
    EXPECT_GT(parts[cable]["tension_peak_n"], 0.0) << cable;
    EXPECT_FALSE(parts[cable].contains("tracking_rmse_deg")) << cable;
  }
  EXPECT_FALSE(parts.contains("nail")) << "it follows by a linkage";
  EXPECT_FALSE(parts.contains("base_extensor"));
}

TEST_F(OtherHandTest, ScoresOnlyJointsThatTheGloveMoves) {
  const ProgramResult result =
      Gauntlet({"run", kThreeJoints, "--out", "out", "--set",
                "joint_map.middle={channels: [], offset_deg: 30}", "--set", "video.channel=tip"});
  ASSERT_EQ(result.exit_code, 0) << result.standard_error;
  EXPECT_THAT(result.standard_output, HasSubstr("2 of 3 joints"));
  EXPECT_FALSE(Scores()["controllers"][0]["channels"].contains("middle"));
}

TEST_F(OtherHandTest, SaysWhichJointsThereAreForOneThatThereIsNot) {
  const ProgramResult result = Gauntlet(
      {"run", kThreeJoints, "--out", "out", "--set", "joint_map.nail={channels: [index_pip]}"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.standard_error,
              HasSubstr("joint_map.nail: is not a joint of the hand, which has base, tip, middle"));
  EXPECT_FALSE(fs::exists(folder_.path() / "out"));
}

TEST_F(OtherHandTest, IsComparedWithABaselineAndShownOnThePageAndInTheVideo) {
  const ProgramResult result =
      Gauntlet({"compare", kThreeJoints, "--seeds", "2", "--out", "out", "--video"});
  ASSERT_EQ(result.exit_code, 0) << result.standard_error;
  EXPECT_THAT(result.standard_output, HasSubstr("tuned_kalman"));
  EXPECT_GT(fs::file_size(folder_.path() / "out" / "comparison.mp4"), 1000u);

  const Json page = PageData();
  EXPECT_EQ(page["baseline"], "raw");
  EXPECT_EQ(Scores()["baseline"], "raw");
  EXPECT_EQ(page["channels"], Json({"base", "tip", "middle"}));
  ASSERT_TRUE(page["latency"].is_object())
      << "one joint's commands decide its angle: that is enough";
  for (const Json& stage : page["latency"]["stages"]) {
    for (const Json& value : stage["ms"]) EXPECT_TRUE(value.is_number()) << stage;
  }
  if (RunProgram({"sh", "-c", "command -v chromium"}).exit_code != 0) return;
  const Json seen = UsePage();
  EXPECT_EQ(seen["problems"], Json::array());
  for (const char* joint : {"base", "middle", "tip"}) EXPECT_GT(seen["inks"][joint], 1000) << joint;
}

/// The prosthesis with five motors, in all scenarios of grasps without an object.
TEST_F(OtherHandTest, AllGraspsRunOnTheHandOfFiveMotors) {
  const std::string model = "hand.model_path=" + SourceDir() + "/models/five_motor_hand.xml";
  for (const char* grasp : {"hook", "lateral", "open", "point", "power", "precision", "tripod"}) {
    const ProgramResult result =
        Gauntlet({"run", SourceDir() + "/scenarios/grasp_" + grasp + ".yaml", "--out", "out",
                  "--controllers", "raw", "--set", model, "score.noise_free_twin=false",
                  "video.channel=thumb_mcp", "glove.motion.repeats=1"});
    ASSERT_EQ(result.exit_code, 0) << grasp << ": " << result.standard_error;
    EXPECT_THAT(result.standard_output, HasSubstr("10 of 10 joints")) << grasp;
    EXPECT_THAT(result.standard_error, testing::Not(HasSubstr("warning"))) << grasp;
  }
  const ProgramResult bottle = Gauntlet(
      {"run", SourceDir() + "/scenarios/grasp_bottle.yaml", "--out", "out", "--set", model});
  EXPECT_EQ(bottle.exit_code, 2);
  EXPECT_THAT(bottle.standard_error, HasSubstr("the model has no body 'object'"));
}

}  // namespace
}  // namespace gauntlet::test
