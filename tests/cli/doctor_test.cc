// `gauntlet doctor` as a program.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "tests/support/program.h"

namespace gauntlet::test {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::ContainsRegex;
using testing::HasSubstr;
using testing::Not;

class DoctorTest : public testing::Test {
 protected:
  ProgramResult Doctor() {
    ProgramOptions options;
    options.working_directory = folder_.path();
    options.environment = {{"PATH", (folder_.path() / "bin").string()}};
    return RunProgram({GAUNTLET_PROGRAM, "doctor"}, options);
  }

  TemporaryDirectory folder_;
};

TEST_F(DoctorTest, EveryLineIsOkOrSaysWhatToDoAndNothingIsLeft) {
  const ProgramResult result = Doctor();
  EXPECT_EQ(result.exit_code, 0) << result.standard_output;
  EXPECT_EQ(result.standard_error, "");
  EXPECT_THAT(result.standard_output,
              AllOf(ContainsRegex("(ok   |note ) system     .*Linux .*glibc 2"),
                    HasSubstr("\nok    MuJoCo     2.2.2, "), HasSubstr("\nok    output     "),
                    HasSubstr("\nok    video      OSMesa draws"), ContainsRegex("avcodec [0-9]+"),
                    ContainsRegex("\n(ok   |note ) real time "), Not(HasSubstr("\nfix")),
                    testing::EndsWith("\ncompare --video can run.\n")));
  EXPECT_TRUE(fs::is_empty(folder_.path()));
}

TEST_F(DoctorTest, ToolsAreFoundAlongThePath) {
  EXPECT_THAT(Doctor().standard_output, AllOf(HasSubstr("note  Chromium   not found; "),
                                              HasSubstr("note  Slurm      not found; "),
                                              HasSubstr("apt-get install slurm-client\n")));
  const fs::path tool = folder_.path() / "bin" / "sbatch";
  fs::create_directory(tool.parent_path());
  std::ofstream(tool) << "#!/bin/sh\n";
  fs::permissions(tool, fs::perms{0755});
  EXPECT_THAT(Doctor().standard_output, HasSubstr("ok    Slurm      " + tool.string() + "\n"));
}

TEST_F(DoctorTest, AnOutputFolderThatCannotBeWrittenIsToBeMended) {
  std::ofstream(folder_.path() / "out") << "a file\n";
  const ProgramResult result = Doctor();
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_THAT(
      result.standard_output,
      AllOf(ContainsRegex("\nfix   output     .*out.*: change to a folder that you may write\n"),
            HasSubstr("\nok    MuJoCo "), testing::EndsWith("\ncompare --video cannot run.\n")));
}

TEST_F(DoctorTest, AMissingModelIsToBeMended) {
  ProgramOptions options;
  options.working_directory = folder_.path();
  options.environment = {{"GAUNTLET_DATA_DIR", folder_.path().string()}};
  const ProgramResult result = RunProgram({GAUNTLET_PROGRAM, "doctor"}, options);
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_THAT(result.standard_output, ContainsRegex("\nfix   MuJoCo     .*GAUNTLET_DATA_DIR"));
}

}  // namespace
}  // namespace gauntlet::test
