// `gauntlet diff` as a program: exit codes, messages, JSON.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "tests/support/program.h"
#include "tests/support/source_dir.h"

namespace gauntlet::test {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;

class DiffTest : public testing::Test {
 protected:
  ProgramResult Gauntlet(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), GAUNTLET_PROGRAM);
    ProgramOptions options;
    options.working_directory = folder_.path();
    return RunProgram(arguments, options);
  }
  /// A comparison of two controllers over half a second.
  void Compare(const std::string& out, std::vector<std::string> options) {
    options.insert(options.begin(),
                   {"compare", SourceDir() + "/scenarios/hold_still.yaml", "--controllers",
                    "raw,mean_20", "--set", "glove.motion.duration_s=0.5", "--out", out});
    const ProgramResult result = Gauntlet(std::move(options));
    ASSERT_EQ(result.exit_code, 0) << result.standard_error;
  }
  fs::path In(const std::string& folder, const std::string& file) const {
    return folder_.path() / folder / file;
  }
  void ExpectMistake(const std::string& a, const std::string& b, const std::string& message) {
    const ProgramResult result = Gauntlet({"diff", a, b});
    EXPECT_EQ(result.exit_code, 2);
    EXPECT_EQ(result.standard_output, "");
    EXPECT_THAT(result.standard_error, HasSubstr(message));
    EXPECT_EQ(std::ranges::count(result.standard_error, '\n'), 1) << result.standard_error;
  }

  TemporaryDirectory folder_;
};

TEST_F(DiffTest, ExitsWithZeroForARepeatedComparison) {
  Compare("a", {"--seeds", "3"});
  Compare("b", {"--seeds", "3", "--jobs", "1"});
  const ProgramResult result = Gauntlet({"diff", "a", "b"});
  EXPECT_EQ(result.exit_code, 0) << result.standard_output;
  EXPECT_EQ(result.standard_error, "");
  EXPECT_THAT(result.standard_output, HasSubstr("have the same settings"));
}

TEST_F(DiffTest, ExitsWithOneAndNamesTheSettingAndTheScoresThatItChanged) {
  Compare("a", {"--seeds", "3"});
  Compare("b", {"--seeds", "3", "--set", "controllers.mean_20.filter.window=80"});
  const ProgramResult text = Gauntlet({"diff", "a", "b"});
  EXPECT_EQ(text.exit_code, 1);
  EXPECT_EQ(text.standard_error, "");
  EXPECT_THAT(text.standard_output,
              AllOf(HasSubstr("controllers.mean_20.filter.0.window: 20 -> 80"),
                    HasSubstr("mean_20"), HasSubstr("better"),
                    testing::Not(HasSubstr("\nraw"))));  // the same seeds, the same scores
  const ProgramResult json = Gauntlet({"diff", "a", "b", "--json"});
  EXPECT_EQ(json.exit_code, 1);
  const auto parsed = nlohmann::json::parse(json.standard_output);
  EXPECT_EQ(parsed["same"], false);
  EXPECT_EQ(parsed["method"], "paired");
  EXPECT_EQ(parsed["settings"].size(), 1u);
}

TEST_F(DiffTest, AnotherSeedIsAnotherSetting) {
  Compare("a", {"--seeds", "2"});
  Compare("b", {"--seeds", "2", "--set", "seed=50"});
  const ProgramResult result = Gauntlet({"diff", "a", "b"});
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_THAT(result.standard_output, AllOf(HasSubstr("seed: 1 -> 50"), HasSubstr("50 to 51")));
}

TEST_F(DiffTest, ARunIsTheSameAsItsSeedOfAComparison) {
  Compare("a", {"--seeds", "1"});
  Compare("b", {"--seeds", "3"});
  const ProgramResult result = Gauntlet({"diff", "a", "b"});
  EXPECT_EQ(result.exit_code, 0) << result.standard_output;
  EXPECT_THAT(result.standard_output, HasSubstr("of the common seed 1"));
}

TEST_F(DiffTest, MistakesAreOneLineAndExitWithTwo) {
  Compare("a", {"--seeds", "1"});
  EXPECT_EQ(Gauntlet({"diff", "a"}).exit_code, 2);
  ExpectMistake("a", "nowhere", "nowhere: is not a folder");
  ExpectMistake("a/scores.csv", "a", "a/scores.csv: is not a folder");
  fs::create_directory(folder_.path() / "empty");
  ExpectMistake("a", "empty", "empty: no scenario.resolved.yaml there");

  fs::create_directory(folder_.path() / "half");
  fs::copy(In("a", "scenario.resolved.yaml"), In("half", "scenario.resolved.yaml"));
  ExpectMistake("half", "a", "half: no scores.csv there");
  std::ofstream(In("half", "scores.csv")) << "seed,controller,channel,charm\n1,raw,summary,2\n";
  ExpectMistake("half", "a", "half/scores.csv:1:4: unknown column charm");

  fs::copy(folder_.path() / "a", folder_.path() / "old");
  std::ofstream(In("old", "scenario.resolved.yaml"), std::ios::app) << "charm: 3\n";
  ExpectMistake("old", "a", "old/scenario.resolved.yaml: is not as its run wrote it");
  fs::remove(In("old", "manifest.json"));  // now it is taken as it is
  const ProgramResult unchecked = Gauntlet({"diff", "old", "a"});
  EXPECT_EQ(unchecked.exit_code, 2);
  EXPECT_THAT(unchecked.standard_error, HasSubstr("charm: unknown key"));
}

TEST_F(DiffTest, HelpHasAnExample) {
  const ProgramResult result = Gauntlet({"diff", "--help"});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_THAT(result.standard_output, AllOf(HasSubstr("Example"), HasSubstr("Exit codes")));
}

}  // namespace
}  // namespace gauntlet::test
