// Signals: the program ends soon, with one line and its exit code, and leaves nothing half-written.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <thread>

#include "tests/support/program.h"
#include "tests/support/source_dir.h"

namespace gauntlet::test {
namespace {

namespace fs = std::filesystem;
using std::chrono::milliseconds;
using testing::EndsWith;
using testing::HasSubstr;

const std::string kProgram = GAUNTLET_PROGRAM;
const std::string kHoldStill = SourceDir() + "/scenarios/hold_still.yaml";

/// Of all programs that have ended so far.
double ProcessorTimeS() {
  rusage used = {};
  getrusage(RUSAGE_CHILDREN, &used);
  const auto seconds = [](const timeval& time) {
    return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
  };
  return seconds(used.ru_utime) + seconds(used.ru_stime);
}

class SignalsTest : public testing::Test {
 protected:
  std::vector<std::string> Names(const std::string& folder = ".") const {
    std::vector<std::string> names;
    std::error_code missing;
    for (const auto& entry : fs::directory_iterator(folder_.path() / folder, missing)) {
      names.push_back(entry.path().filename().string());
    }
    std::ranges::sort(names);
    return names;
  }
  std::vector<std::string> Compare(const std::string& out, int seeds) const {
    return {kProgram,
            "compare",
            kHoldStill,
            "--seeds",
            std::to_string(seeds),
            "--controllers",
            "raw",
            "--set",
            "glove.motion.duration_s=0.4",
            "--out",
            out};
  }
  Program Start(std::vector<std::string> command) const {
    return Program(command, {.working_directory = folder_.path()});
  }
  static void ExpectOneLine(const ProgramResult& result, int signal) {
    EXPECT_EQ(result.exit_code, 128 + signal) << result.signal;
    EXPECT_EQ(result.standard_output, "");
    const std::string line = "gauntlet: interrupted; nothing half-written was left";
    EXPECT_EQ(result.standard_error.rfind(line), result.standard_error.find(line));
    EXPECT_THAT(result.standard_error, HasSubstr(line));
    EXPECT_THAT(result.standard_error, EndsWith("\n"));
  }

  TemporaryDirectory folder_;
};

TEST_F(SignalsTest, AComparisonKeepsItsTrialsAndNothingElse) {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGQUIT}) {
    const std::string out = "out_" + std::to_string(signal);
    Program program = Start(Compare(out, 5000));
    ASSERT_TRUE(program.WaitForPath(folder_.path() / out / "study.db"));
    program.SendSignal(signal);
    ExpectOneLine(program.Wait(), signal);
    std::vector<std::string> names = Names(out);
    std::erase(names, "study.db");  // there if a trial was finished
    EXPECT_EQ(names, std::vector<std::string>()) << signal;
  }
}

TEST_F(SignalsTest, ASecondSignalLeavesNoTemporaryFile) {
  for (const int wait_ms : {0, 1, 3}) {
    const std::string out = "out_" + std::to_string(wait_ms);
    Program program = Start(Compare(out, 5000));
    ASSERT_TRUE(program.WaitForPath(folder_.path() / out / "study.db"));
    program.SendSignal(SIGINT);
    std::this_thread::sleep_for(milliseconds(wait_ms));
    program.SendSignal(SIGINT);
    const ProgramResult result = program.Wait();
    ExpectOneLine(result, SIGINT);
    std::vector<std::string> names = Names(out);
    if (std::erase(names, "study.db") > 0) {  // there if a trial was finished
      EXPECT_THAT(result.standard_error,
                  HasSubstr("kept in " + out + "/study.db: the same command continues from there"));
    }
    EXPECT_EQ(names, std::vector<std::string>()) << wait_ms;
  }
}

TEST_F(SignalsTest, AtAnyMomentTheFolderIsAsBeforeOrWhole) {
  ASSERT_EQ(Start(Compare("out", 2)).Wait().exit_code, 0);
  const std::vector<std::string> whole = Names("out");
  int signal = SIGHUP;
  for (const int wait_ms : {10, 60, 120, 200, 300, 450}) {
    std::vector<std::string> command = {
        kProgram, "run",   kHoldStill, "--controllers", "raw", "--set", "glove.motion.duration_s=2",
        "--csv",  "--out", "out"};
    Program program = Start(command);
    ASSERT_TRUE(program.WaitForHandlerOf(signal));
    std::this_thread::sleep_for(milliseconds(wait_ms));
    program.SendSignal(signal);
    const ProgramResult& result = program.Wait();
    if (result.exit_code != 0) ExpectOneLine(result, signal);
    std::vector<std::string> names = Names("out");
    std::erase(names, "trace.raw.csv");
    EXPECT_EQ(names, whole) << wait_ms;
    EXPECT_EQ(RunProgram({kProgram, "diff", "out", "out"}, {.working_directory = folder_.path()})
                  .exit_code,
              0);
    signal = signal == SIGHUP ? SIGQUIT : SIGHUP;
  }
}

TEST_F(SignalsTest, AVideoThatIsNotFinishedGoesAway) {
  ASSERT_EQ(Start(Compare("out", 1)).Wait().exit_code, 0);
  const std::vector<std::string> whole = Names("out");
  for (const int wait_ms : {100, 250, 400}) {
    Program program = Start({kProgram, "render", "out"});
    ASSERT_TRUE(program.WaitForHandlerOf(SIGHUP));
    std::this_thread::sleep_for(milliseconds(wait_ms));
    program.SendSignal(SIGHUP);
    if (program.Wait().exit_code == 0) continue;  // was too fast
    ExpectOneLine(program.Wait(), SIGHUP);
    EXPECT_EQ(Names("out"), whole) << wait_ms;
  }
}

TEST_F(SignalsTest, AreHeardWhileTheGlovesSignalOfAnHourIsMade) {
  for (const int signal : {SIGINT, SIGTERM}) {
    const double before_s = ProcessorTimeS();
    Program program = Start({kProgram, "run", SourceDir() + "/scenarios/random_motion.yaml",
                             "--set", "glove.motion.duration_s=3600", "--out", "out"});
    ASSERT_TRUE(program.WaitForHandlerOf(signal));
    std::this_thread::sleep_for(milliseconds(300));
    program.SendSignal(signal);
    ExpectOneLine(program.Wait(), signal);
    EXPECT_TRUE(Names().empty());
    EXPECT_LT(ProcessorTimeS() - before_s, 2.5);  // to make it takes more than 4 s
  }
}

TEST_F(SignalsTest, WhatWasToBeIgnoredStaysSo) {
  std::string command = "trap '' HUP INT; echo started; exec";
  for (const std::string& word : Compare("out", 2)) command += " " + word;
  Program program = Start({"/bin/sh", "-c", command});
  ASSERT_TRUE(program.WaitForText("started"));
  ASSERT_TRUE(program.WaitForPath(folder_.path() / "out"));
  program.SendSignal(SIGHUP);
  program.SendSignal(SIGINT);
  EXPECT_EQ(program.Wait().exit_code, 0) << program.Wait().standard_error;
}

TEST_F(SignalsTest, AQuotaOfFilesIsAnErrorOfWriting) {
  // In blocks of 512 bytes: the page, of 1.6 MB, fits, and the trace, of 2.1 MB, does not.
  const ProgramResult result =
      RunProgram({"/bin/sh", "-c",
                  "ulimit -f 3500; exec " + kProgram + " run " + kHoldStill +
                      " --controllers raw --set glove.motion.duration_s=2 --out out"},
                 {.working_directory = folder_.path()});
  EXPECT_EQ(result.exit_code, 1) << result.signal;
  EXPECT_THAT(result.standard_error, HasSubstr("gauntlet: out/trace.h5: cannot write"));
  EXPECT_TRUE(Names().empty());
}

}  // namespace
}  // namespace gauntlet::test
