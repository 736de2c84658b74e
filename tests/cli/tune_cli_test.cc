// gauntlet tune from the outside: which filter to use, and what it leaves to be used.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "tests/support/program.h"

namespace gauntlet::test {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;

class TuneCommandTest : public testing::Test {
 protected:
  TuneCommandTest() { Write("small.yaml", "  raw: {filter: none}\n"); }
  void Write(const std::string& name, const std::string& controllers) const {
    std::ofstream(folder_.path() / name)
        << "question: Which filter?\n"
           "glove:\n"
           "  rate_hz: 60\n"
           "  channels: [index_mcp]\n"
           "  motion: {kind: random, duration_s: 4, bandwidth_hz: 1}\n"
           "controllers:\n" +
               controllers;
  }
  ProgramResult Run(const std::vector<std::string>& words) const {
    std::vector<std::string> command = {GAUNTLET_PROGRAM};
    command.insert(command.end(), words.begin(), words.end());
    return RunProgram(command, {.working_directory = folder_.path()});
  }
  ProgramResult TuneAll(const std::vector<std::string>& more) const {
    std::vector<std::string> words = {"tune", "small.yaml", "--all", "--filter-only", "--seeds",
                                      "2",    "--held-out", "2",     "--evaluations", "4"};
    words.insert(words.end(), more.begin(), more.end());
    return Run(words);
  }

  TemporaryDirectory folder_;
};

TEST_F(TuneCommandTest, AllSaysWhichFilterToUseAndLeavesItToBeIncluded) {
  const ProgramResult result = TuneAll({});
  ASSERT_EQ(result.exit_code, 0) << result.standard_error;
  EXPECT_THAT(
      result.standard_output,
      AllOf(HasSubstr("each kind of filter as its filter"), HasSubstr("to the best"),
            HasSubstr("has the least tracking_rmse_deg"), HasSubstr("kalman_dense: gives")));
  std::ostringstream page;
  page << std::ifstream(folder_.path() / "out/small.tune/report.html").rdbuf();
  EXPECT_THAT(page.str(), AllOf(HasSubstr("class=\"fronts\""), HasSubstr("class=\"answer\""),
                                HasSubstr("controllers.raw.filter={kind: median, window:")));
  Write("with.yaml", "  raw: {filter: none}\n  tuned: !include out/small.tune/kalman.yaml\n");
  const ProgramResult with = Run({"run", "with.yaml"});
  EXPECT_EQ(with.exit_code, 0) << with.standard_error;
}

TEST_F(TuneCommandTest, AllFailsWhereNoKindKeepsTheBounds) {
  const ProgramResult result = TuneAll({"--subject-to", "jitter_rms_deg<=1e-9", "--json"});
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_THAT(result.standard_error, HasSubstr("no kind of filter has an answer"));
  const auto json = nlohmann::json::parse(result.standard_output);
  EXPECT_THAT(json["filters"][0]["problem"].get<std::string>(),
              HasSubstr("1 that was tried keeps"));
}

TEST_F(TuneCommandTest, MistakesAreOneLine) {
  const auto mistake = [this](const std::vector<std::string>& words, const std::string& problem) {
    std::vector<std::string> command = {"tune", "small.yaml"};
    command.insert(command.end(), words.begin(), words.end());
    const ProgramResult result = Run(command);
    EXPECT_EQ(result.exit_code, 2) << result.standard_error;
    EXPECT_THAT(result.standard_error, HasSubstr(problem));
    EXPECT_EQ(std::ranges::count(result.standard_error, '\n'), 1) << result.standard_error;
  };
  mistake({"--all", "--free", "filter.q=1:2"}, "--free: and --all contradict each other");
  mistake({"--controller", "raw"}, "--free: is needed, or --all");
  mistake({"--free", "filter.q=1:2"}, "--controller: is needed, or --all");
  mistake({"--all", "--controller", "row"}, "unknown controller (did you mean raw?)");
  mistake({"--controller", "raw", "--free", "motor.speed_limit_rad_s=0:20000"},
          "speed_limit_rad_s: is 20000, must be");
  mistake({"--controller", "raw", "--free", "filter.q=0.1:0.9:whole"},
          "--free: filter.q=0.1:0.9:whole: from 0.1 to 0.9 lies no whole number, the range must "
          "have one");
  mistake({"--controller", "raw", "--free", "filter.q=1.1:1.9:log:whole"}, "lies no whole number");
}

TEST_F(TuneCommandTest, WholeNumbersStayWithinTheirRange) {
  Write("median.yaml", "  median: {filter: {kind: median, window: 5}}\n");
  const ProgramResult result =
      Run({"tune", "median.yaml", "--controller", "median", "--free", "filter.window=1.6:3.4:whole",
           "--evaluations", "8", "--seeds", "2", "--held-out", "2", "--filter-only"});
  ASSERT_EQ(result.exit_code, 0) << result.standard_error;
  std::ifstream table(folder_.path() / "out/median.tune/tune.csv");
  std::string line;
  std::getline(table, line);
  ASSERT_THAT(line, HasSubstr("window"));
  std::set<std::string> tried;
  const auto column = std::ranges::count(line.substr(0, line.find("window")), ',');
  while (std::getline(table, line)) {
    std::istringstream cells(line);
    std::string cell;
    for (std::ptrdiff_t i = 0; i <= column; ++i) std::getline(cells, cell, ',');
    tried.insert(cell);
  }
  EXPECT_THAT(tried, testing::ElementsAre("2", "3"));
}

}  // namespace
}  // namespace gauntlet::test
