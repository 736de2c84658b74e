// Who is held against whom, and what chance has to say: in the table, in scores.json, on the page.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/support/program.h"
#include "tests/support/read_file.h"
#include "tests/support/source_dir.h"

namespace gauntlet::test {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using Json = nlohmann::json;

class BaselineTest : public testing::Test {
 protected:
  /// A comparison; what it printed is `table_`, what it wrote `scores_` and `page_`.
  void Compare(const std::string& scenario, const std::vector<std::string>& more) {
    std::vector<std::string> command = {
        GAUNTLET_PROGRAM, "compare", SourceDir() + "/scenarios/" + scenario, "--seeds", "5",
        "--out",          "out"};
    command.insert(command.end(), more.begin(), more.end());
    ProgramOptions options;
    options.working_directory = folder_.path();
    const ProgramResult result = RunProgram(command, options);
    ASSERT_EQ(result.exit_code, 0) << result.standard_error;
    table_ = result.standard_output;
    scores_ = Json::parse(ReadFile("scores.json"));
    const std::string page = ReadFile("report.html");
    const std::string mark = "<script type=\"application/json\" id=\"data\">";
    const std::size_t begin = page.find(mark) + mark.size();
    page_ = Json::parse(page.substr(begin, page.find("</script>", begin) - begin));
  }

  std::string ReadFile(const std::string& name) const {
    return test::ReadFile(folder_.path() / "out" / name);
  }

  static bool HasChromium() {
    return RunProgram({"sh", "-c", "command -v chromium"}).exit_code == 0;
  }
  /// What a person reads on the page, without the settings at its end.
  std::string PageText() const {
    const ProgramResult result = RunProgram(
        {"chromium", "--headless", "--no-sandbox", "--disable-gpu", "--no-first-run",
         "--disable-dev-shm-usage", "--user-data-dir=" + (folder_.path() / "profile").string(),
         "--virtual-time-budget=4000", "--dump-dom",
         "file://" + (folder_.path() / "out" / "report.html").string()});
    std::string text;
    std::size_t at = 0;
    const std::string& html = result.standard_output;
    const auto drop = [&](const char* open, const char* close) {
      if (html.compare(at, std::string(open).size(), open) != 0) return false;
      at = std::min(html.find(close, at), html.size() - 1) + std::string(close).size();
      return true;
    };
    while (at < html.size()) {
      if (drop("<script", "</script>") || drop("<style", "</style>") || drop("<", ">")) continue;
      text += html[at++];
    }
    return text.substr(0, text.find("Settings and versions"));
  }

  TemporaryDirectory folder_;
  std::string table_;
  Json scores_;
  Json page_;
};

const std::vector<std::string> kFiltersOnly = {"--controllers", "mean_20,paper_kalman,tuned_kalman",
                                               "--set", "glove.motion.duration_s=2"};

TEST_F(BaselineTest, WithoutAnUnfilteredControllerNothingIsWorseThanAnything) {
  Compare("random_motion.yaml", kFiltersOnly);
  EXPECT_THAT(table_,
              AllOf(Not(HasSubstr("baseline")), Not(HasSubstr("!")), Not(HasSubstr("worse"))));
  EXPECT_EQ(scores_["baseline"], nullptr);
  EXPECT_EQ(page_["baseline"], nullptr);
  for (const Json& controller : scores_["controllers"]) {
    EXPECT_FALSE(controller.contains("difference_to_baseline")) << controller["name"];
  }
  if (!HasChromium()) return;
  EXPECT_THAT(PageText(), AllOf(HasSubstr("tuned_"), HasSubstr("baseline: NAME"),
                                Not(HasSubstr("compared with raw"))));
}

TEST_F(BaselineTest, IsTheControllerThatTheScenarioNames) {
  std::vector<std::string> more = kFiltersOnly;
  more.insert(more.end(), {"--set", "baseline=paper_kalman"});
  Compare("random_motion.yaml", more);
  EXPECT_THAT(table_, HasSubstr("(compared with paper_kalman)"));
  EXPECT_EQ(scores_["baseline"], "paper_kalman");
  EXPECT_EQ(page_["baseline"], "paper_kalman");
  const Json& mean = scores_["controllers"][0];
  EXPECT_EQ(mean["difference_to_baseline"]["delay_ms"]["verdict"], "worse");
  EXPECT_GT(mean["difference_to_baseline"]["delay_ms"]["low"], 0.0);
  EXPECT_FALSE(scores_["controllers"][1].contains("difference_to_baseline"));  // it itself
  if (!HasChromium()) return;
  EXPECT_THAT(PageText(), HasSubstr("compared with paper_kalman"));
}

TEST_F(BaselineTest, IsNoPredictorThatStandsBeforeTheUnfilteredOne) {
  Compare("random_motion.yaml",
          {"--controllers", "mean_20,raw", "--set", "glove.motion.duration_s=2", "--set",
           "controllers.mean_20={filter: none, prediction: {kind: linear, horizon_ms: 40}}"});
  EXPECT_EQ(scores_["baseline"], "raw");
  EXPECT_THAT(table_, Not(HasSubstr("worse than mean_20")));
}

TEST_F(BaselineTest, SeedsThatGiveTheSameRunSayNothingOfChance) {
  Compare("sign_glove.yaml", {"--set", "glove.motion.duration_s=4"});
  EXPECT_THAT(table_, AllOf(HasSubstr("The recording is too short: it gives confidence"),
                            HasSubstr("seed 1;"), Not(HasSubstr("±")), Not(HasSubstr("*")),
                            Not(HasSubstr("!"))));
  EXPECT_EQ(scores_["seeds"], Json({1}));
  EXPECT_EQ(scores_["seeds_alike"], true);
  EXPECT_EQ(page_["comparison"], false);
  for (const Json& controller : scores_["controllers"]) {
    if (controller.contains("difference_to_baseline")) {
      for (const auto& [metric, difference] : controller["difference_to_baseline"].items()) {
        EXPECT_TRUE(difference["verdict"].is_null()) << metric;
      }
    }
    EXPECT_TRUE(controller["summary"]["tracking_rmse_deg"]["mean"].is_number());
    for (const auto& [metric, estimate] : controller["summary"].items()) {
      EXPECT_TRUE(estimate["ci95_low"].is_null()) << metric;
      EXPECT_TRUE(estimate["ci95_high"].is_null()) << metric;
    }
  }
  const std::string first = scores_.dump();
  Compare("sign_glove.yaml", {"--set", "glove.motion.duration_s=4"});  // again, in the same folder
  EXPECT_EQ(scores_.dump(), first);
  if (!HasChromium()) return;
  EXPECT_THAT(PageText(), AllOf(HasSubstr("One run has no confidence interval"),
                                Not(HasSubstr("±")), Not(HasSubstr("compared with raw"))));
}

}  // namespace
}  // namespace gauntlet::test
