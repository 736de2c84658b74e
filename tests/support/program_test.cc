#include "tests/support/program.h"

#include <gtest/gtest.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <string>
#include <system_error>
#include <thread>

namespace gauntlet::test {
namespace {

using std::chrono::milliseconds;

/// A killed process stays visible as a zombie until its new parent has collected it.
bool IsRunning(const std::filesystem::path& proc_directory) {
  std::ifstream stat(proc_directory / "stat");
  std::string process, name, state;
  return stat >> process >> name >> state && state != "Z" && state != "X";
}

TEST(Program, SeparatesOutputErrorAndExitCode) {
  const ProgramResult result = RunProgram({"sh", "-c", "echo out; echo err >&2; exit 3"});
  EXPECT_EQ(result.standard_output, "out\n");
  EXPECT_EQ(result.standard_error, "err\n");
  EXPECT_EQ(result.exit_code, 3);
  EXPECT_EQ(result.signal, 0);
  EXPECT_FALSE(result.timed_out);
}

// More than a pipe holds, in both directions at once: a helper that writes first would hang.
TEST(Program, PassesLargeInputThrough) {
  const std::string input(1'000'000, 'x');
  EXPECT_EQ(RunProgram({"cat"}, {.standard_input = input}).standard_output, input);
}

TEST(Program, SurvivesProgramThatReadsNothing) {
  const std::string input(1'000'000, 'x');
  EXPECT_EQ(RunProgram({"true"}, {.standard_input = input}).exit_code, 0);
}

TEST(Program, GivesArgumentsEnvironmentAndDirectory) {
  const TemporaryDirectory directory;
  const ProgramResult result =
      RunProgram({"/bin/sh", "-c", "pwd; echo \"$1|$KEY|${HOME-no home}\"", "sh", "a b"},
                 {.environment = {{"KEY", "value"}},
                  .inherit_environment = false,
                  .working_directory = directory.path()});
  EXPECT_EQ(result.standard_output, directory.path().string() + "\na b|value|no home\n");
}

TEST(Program, ReportsSignalThatEndedIt) {
  Program program({"sh", "-c", "echo ready; sleep 60"});
  ASSERT_TRUE(program.WaitForText("ready"));
  program.SendSignal(SIGTERM);
  EXPECT_EQ(program.Wait().signal, SIGTERM);
  EXPECT_EQ(program.Wait().exit_code, -1);
}

TEST(Program, StopsAtTimeoutWithEverythingItStarted) {
  const ProgramResult result =
      RunProgram({"sh", "-c", "sleep 60 & echo $!; wait"}, {.timeout = milliseconds(200)});
  EXPECT_TRUE(result.timed_out);
  const std::string grandchild = "/proc/" + std::to_string(std::stoi(result.standard_output));
  for (int i = 0; i < 500 && IsRunning(grandchild); ++i) {
    std::this_thread::sleep_for(milliseconds(10));
  }
  EXPECT_FALSE(IsRunning(grandchild));
}

TEST(Program, HasATerminalIfAsked) {
  const std::string is_terminal = "test -t 0 && test -t 2 && ! test -t 1";
  EXPECT_EQ(RunProgram({"sh", "-c", is_terminal}, {.on_terminal = true}).exit_code, 0);
  EXPECT_NE(RunProgram({"sh", "-c", is_terminal}).exit_code, 0);
  const ProgramResult cat = RunProgram({"cat"}, {.standard_input = "a\n\x04", .on_terminal = true});
  EXPECT_EQ(cat.standard_output, "a\n");
  EXPECT_EQ(cat.exit_code, 0);
}

TEST(Program, TypesAnInterruptAtItsTerminal) {
  Program program({"sh", "-c", "echo ready; read line"}, {.on_terminal = true});
  ASSERT_TRUE(program.WaitForText("ready"));
  program.Type("\x03");
  EXPECT_EQ(program.Wait().signal, SIGINT);
}

TEST(Program, FailsForProgramThatDoesNotExist) {
  EXPECT_THROW(RunProgram({"/nowhere/program"}), std::system_error);
}

TEST(TemporaryDirectory, GoesAwayWithItsContent) {
  std::filesystem::path path;
  {
    const TemporaryDirectory directory;
    path = directory.path();
    std::ofstream(path / "file") << "content";
    EXPECT_TRUE(std::filesystem::exists(path / "file"));
  }
  EXPECT_FALSE(std::filesystem::exists(path));
}

}  // namespace
}  // namespace gauntlet::test
