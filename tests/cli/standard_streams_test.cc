// Standard streams that are closed, full or read by nobody; threads that cannot start.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>

#include "tests/support/program.h"
#include "tests/support/read_file.h"
#include "tests/support/source_dir.h"

namespace gauntlet::test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

const std::string kGauntlet = GAUNTLET_PROGRAM;
const std::string kOneController = SourceDir() +
                                   "/scenarios/hold_still.yaml --controllers raw "
                                   "--set glove.motion.duration_s=0.2 ";

class StandardStreamsTest : public testing::Test {
 protected:
  /// The program with `arguments` and redirections, as a shell has them; `before` goes first.
  ProgramResult Gauntlet(const std::string& arguments, const std::string& before = "") const {
    return RunProgram({"/bin/sh", "-c", before + "exec " + kGauntlet + " " + arguments},
                      {.working_directory = folder_.path()});
  }
  fs::path In(const std::string& name) const { return folder_.path() / name; }
  void WriteRecording() const {
    std::ofstream file(In("glove.csv"));
    file << "t_s,index_mcp_counts\n";
    for (int k = 0; k < 2000; ++k) file << 0.001 * k << "," << 500 + k % 3 << "\n";
  }

  TemporaryDirectory folder_;
};

TEST_F(StandardStreamsTest, NothingIsLostWhereStandardErrorCannotBeWritten) {
  ASSERT_EQ(Gauntlet("compare " + kOneController + "--seeds 2 --out a").exit_code, 0);
  const ProgramResult told = Gauntlet("run " + kOneController + "--out told");
  ASSERT_EQ(told.exit_code, 0);
  for (const std::string stream : {" 2>&-", " 2>/dev/full"}) {
    fs::remove_all(In("b"));
    const ProgramResult compare =
        Gauntlet("compare " + kOneController + "--seeds 2 --out b" + stream);
    EXPECT_EQ(compare.exit_code, 0) << stream;
    for (const char* name : {"scores.csv", "trace.h5", "report.html", "manifest.json"}) {
      EXPECT_TRUE(ReadFile(In("a") / name) == ReadFile(In("b") / name)) << name << stream;
    }
    EXPECT_EQ(Gauntlet("run " + kOneController + "--out told" + stream).standard_output,
              told.standard_output);
    EXPECT_EQ(Gauntlet("run nowhere.yaml" + stream).exit_code, 2);
    EXPECT_EQ(Gauntlet("nonsense" + stream).exit_code, 2);
    EXPECT_EQ(Gauntlet("render nowhere" + stream).exit_code, 2);
    EXPECT_EQ(Gauntlet("filter none </dev/null" + stream).exit_code, 2);
  }
}

TEST_F(StandardStreamsTest, ResultsThatNobodyGetsAreAnErrorOfEveryCommand) {
  WriteRecording();
  ASSERT_EQ(Gauntlet("run " + kOneController + "--out o").exit_code, 0);
  for (const std::string& command :
       {std::string("--version"), std::string("--help"), std::string("run --help"),
        "run " + kOneController + "--out o", "run " + kOneController + "--out o --json",
        "compare " + kOneController + "--seeds 2 --out p",
        std::string("calibrate glove.csv --out g.yaml"), std::string("diff o o"),
        std::string("list keys"), std::string("list --json"),
        std::string("filter none < glove.csv")}) {
    for (const std::string stream : {" >/dev/full", " >&-"}) {
      const ProgramResult result = Gauntlet(command + stream);
      EXPECT_EQ(result.exit_code, 1) << command << stream;
      EXPECT_THAT(result.standard_error,
                  HasSubstr("gauntlet: standard output: cannot be written: "))
          << command << stream;
    }
  }
  EXPECT_EQ(Gauntlet("diff o o").exit_code, 0);  // the files are there all the same
}

TEST_F(StandardStreamsTest, AReaderThatHasGoneEndsTheProgramQuietlyButNotItsWork) {
  // A pipe that nobody reads from.
  const std::string pipe = "mkfifo pipe; exec 3<>pipe 4>pipe 3<&-; ";
  const ProgramResult list = Gauntlet("list keys >&4", pipe);
  EXPECT_EQ(list.exit_code, 141);
  EXPECT_EQ(list.standard_error, "");
  const ProgramResult run =
      Gauntlet("run " + kOneController +
                   "--set video.width_px=480 --set video.height_px=270 --video "
                   "--out o >&4",
               "rm pipe; " + pipe);
  EXPECT_EQ(run.exit_code, 141) << run.standard_error;
  EXPECT_THAT(run.standard_error, HasSubstr("wrote o: "));
  EXPECT_TRUE(fs::exists(In("o/comparison.mp4")));
}

TEST_F(StandardStreamsTest, APathChangesNeitherTheLinesOfMessagesNorTheTerminal) {
  const std::string out = "x\n\x1b[2J\xff";
  const ProgramResult result =
      RunProgram({kGauntlet, "run", SourceDir() + "/scenarios/hold_still.yaml", "--controllers",
                  "raw", "--set", "glove.motion.duration_s=0.2", "--out", out},
                 {.working_directory = folder_.path()});
  ASSERT_EQ(result.exit_code, 0) << result.standard_error;
  EXPECT_THAT(result.standard_error, testing::StartsWith("wrote x\\n\\x1b[2J\\xff: report.html, "));
  EXPECT_EQ(std::ranges::count(result.standard_error, '\n'), 1) << result.standard_error;
  EXPECT_TRUE(fs::exists(In(out) / "report.html"));
}

TEST_F(StandardStreamsTest, WithoutFurtherThreadsOneDoesAllTrials) {
  // The stack of a thread would be larger than the address space.
  const std::string no_threads = "ulimit -s 274877906944 && ";
  ASSERT_EQ(Gauntlet("compare " + kOneController + "--seeds 3 --jobs 3 --out a").exit_code, 0);
  const ProgramResult result =
      Gauntlet("compare " + kOneController + "--seeds 3 --jobs 3 --out b", no_threads);
  EXPECT_EQ(result.exit_code, 0) << result.standard_error;
  EXPECT_THAT(result.standard_error, HasSubstr("gauntlet: only 1 of 3 threads can be started: "));
  EXPECT_TRUE(ReadFile(In("a/scores.csv")) == ReadFile(In("b/scores.csv")));
}

}  // namespace
}  // namespace gauntlet::test
