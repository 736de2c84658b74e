// Files of two runs in one folder are never taken for those of one.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "tests/support/program.h"
#include "tests/support/source_dir.h"

namespace gauntlet::test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class MixedFolderTest : public testing::Test {
 protected:
  ProgramResult Gauntlet(std::vector<std::string> arguments) const {
    arguments.insert(arguments.begin(), GAUNTLET_PROGRAM);
    return RunProgram(arguments, {.working_directory = folder_.path()});
  }
  ProgramResult Run(const std::string& out, const std::string& seed) const {
    return Gauntlet({"run", SourceDir() + "/scenarios/hold_still.yaml", "--controllers", "raw",
                     "--set", "glove.motion.duration_s=0.2", "--seed", seed, "--out", out});
  }
  void ExpectRefused(const std::vector<std::string>& command, const std::string& line) const {
    const ProgramResult result = Gauntlet(command);
    EXPECT_EQ(result.exit_code, 2) << command[0];
    EXPECT_EQ(result.standard_error.find("gauntlet: " + line), 0u) << result.standard_error;
    EXPECT_EQ(result.standard_error.find('\n'), result.standard_error.size() - 1);
  }
  fs::path In(const std::string& name) const { return folder_.path() / name; }

  TemporaryDirectory folder_;
};

TEST_F(MixedFolderTest, ARunThatStoppedBetweenTwoRenamesLeavesAFolderThatIsRefused) {
  ASSERT_EQ(Run("a", "1").exit_code, 0);
  ASSERT_EQ(Run("b", "2").exit_code, 0);
  fs::remove(In("a/scores.json"));
  fs::create_directories(In("a/scores.json/in_the_way"));
  const ProgramResult stopped = Run("a", "2");
  EXPECT_EQ(stopped.exit_code, 1);
  EXPECT_THAT(stopped.standard_error, HasSubstr("a/scores.json: cannot write: Is a directory"));
  ExpectRefused({"render", "a"}, "a: holds parts of two runs");
  ExpectRefused({"diff", "a", "b"}, "a: holds parts of two runs");
  ExpectRefused({"diff", "b", "a"}, "a: holds parts of two runs");
  ExpectRefused({"export", "a", "--controller", "raw"}, "a: holds parts of two runs");

  fs::remove_all(In("a/scores.json"));
  ASSERT_EQ(Run("a", "2").exit_code, 0);
  EXPECT_EQ(Gauntlet({"diff", "a", "b"}).exit_code, 0);
  for (const auto& entry : fs::directory_iterator(In("a"))) {
    EXPECT_TRUE(fs::exists(In("b") / entry.path().filename())) << entry.path();
  }
}

TEST_F(MixedFolderTest, AFileOfAnotherRunIsRefusedAndARunTakesAScenarioThatWasChanged) {
  ASSERT_EQ(Run("a", "1").exit_code, 0);
  ASSERT_EQ(Run("b", "2").exit_code, 0);
  for (const char* name : {"trace.h5", "scores.csv", "scenario.resolved.yaml"}) {
    fs::copy_file(In("b") / name, In("a") / name, fs::copy_options::overwrite_existing);
  }
  ExpectRefused({"render", "a"}, "a/scenario.resolved.yaml: is not as its run wrote it");
  ExpectRefused({"diff", "a", "b"}, "a/scenario.resolved.yaml: is not as its run wrote it");
  const ProgramResult again =
      Gauntlet({"run", "a/scenario.resolved.yaml", "--controllers", "raw", "--out", "a"});
  ASSERT_EQ(again.exit_code, 0) << again.standard_error;
  EXPECT_EQ(Gauntlet({"diff", "a", "b"}).exit_code, 0);
  fs::copy_file(In("b/trace.h5"), In("b/scores.csv"), fs::copy_options::overwrite_existing);
  ExpectRefused({"diff", "a", "b"}, "b/scores.csv: is not as its run wrote it");
}

}  // namespace
}  // namespace gauntlet::test
