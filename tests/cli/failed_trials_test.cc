// A hand that diverges: no scores, but the reason everywhere.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>

#include "tests/hand/small_hand.h"
#include "tests/support/program.h"

namespace gauntlet::test {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

TEST(FailedTrials, HaveNoScoresAndAReason) {
  const TemporaryDirectory folder;
  std::ofstream(folder.path() / "hand.xml") << sim::testing::DivergingHandXml("index_mcp");
  std::ofstream(folder.path() / "diverging.yaml") << R"(
question: What is said of a hand that diverges?
glove: {channels: [index_mcp], motion: {kind: hold, duration_s: 2}}
hand: {model_path: hand.xml}
controllers: {raw: {filter: none}, mean: {filter: moving_average}}
)";
  ProgramOptions options;
  options.working_directory = folder.path();
  const auto read = [&](const char* name) {
    std::ostringstream text;
    text << std::ifstream(folder.path() / "out" / name, std::ios::binary).rdbuf();
    return text.str();
  };
  std::string first_scores;
  for (const char* time : {"first", "again, from study.db"}) {
    const ProgramResult result = RunProgram(
        {GAUNTLET_PROGRAM, "compare", "diverging.yaml", "--seeds", "3", "--out", "out"}, options);
    EXPECT_EQ(result.exit_code, 1) << time;
    const char* failed = "raw failed in 3 of 3 trials and is not ranked: at 0.0";
    EXPECT_THAT(result.standard_error, HasSubstr(failed)) << time;
    EXPECT_THAT(result.standard_output,
                AllOf(HasSubstr(failed), HasSubstr("(seed 1)"), HasSubstr("mean failed in 3 of 3"),
                      Not(HasSubstr("Use ")), Not(HasSubstr("±"))))
        << time;
    const auto scores = nlohmann::json::parse(read("scores.json"));
    for (const auto& controller : scores["controllers"]) {
      EXPECT_EQ(controller["failed_trials"], 3);
      EXPECT_THAT(controller["health"].get<std::string>(), HasSubstr("at 0.0"));
      for (const auto& [metric, estimate] : controller["summary"].items()) {
        EXPECT_TRUE(estimate["mean"].is_null()) << metric;
      }
    }
    EXPECT_THAT(read("report.html"), HasSubstr(failed)) << time;
    EXPECT_TRUE(std::filesystem::exists(folder.path() / "out" / "trace.h5")) << time;
    if (first_scores.empty()) first_scores = read("scores.json");
    EXPECT_EQ(read("scores.json"), first_scores) << time;
  }
  const ProgramResult run =
      RunProgram({GAUNTLET_PROGRAM, "run", "diverging.yaml", "--out", "run"}, options);
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_THAT(run.standard_output, HasSubstr("raw failed in 1 of 1 trial and is not ranked"));
  const ProgramResult same = RunProgram({GAUNTLET_PROGRAM, "diff", "out", "out"}, options);
  EXPECT_EQ(same.exit_code, 0) << same.standard_output << same.standard_error;
}

}  // namespace
}  // namespace gauntlet::test
