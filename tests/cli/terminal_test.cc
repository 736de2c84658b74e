// The question of gauntlet inspect at a terminal: its answers, and its ends without one.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/support/program.h"
#include "tests/support/read_file.h"

namespace gauntlet::test {
namespace {

namespace fs = std::filesystem;
using testing::EndsWith;
using testing::HasSubstr;
using testing::Not;

constexpr std::string_view kPrompt = "\n> ";

class TerminalTest : public testing::Test {
 protected:
  /// Whole numbers from 0 to 200, 50 rows per second, of columns without a meaning.
  void WriteSensors(const std::string& name, int sensors) const {
    std::ofstream file(folder_.path() / name);
    file << "time_s";
    for (int i = 0; i < sensors; ++i) file << ",glove_q" << i;
    file << "\n";
    for (int k = 0; k < 300; ++k) {
      file << 0.02 * k;
      for (int i = 0; i < sensors; ++i)
        file << "," << std::lround(100.0 + 99.0 * sin(0.05 * k + i));
      file << "\n";
    }
  }
  Program Inspect(std::vector<std::string> arguments, const std::string& typed,
                  bool on_terminal = true) const {
    std::vector<std::string> command = {GAUNTLET_PROGRAM, "inspect"};
    std::ranges::copy(arguments, std::back_inserter(command));
    return Program(
        command,
        {.standard_input = typed, .working_directory = folder_.path(), .on_terminal = on_terminal});
  }
  std::vector<std::string> Names() const {
    std::vector<std::string> names;
    for (const auto& entry : fs::directory_iterator(folder_.path())) {
      names.push_back(entry.path().filename().string());
    }
    std::ranges::sort(names);
    return names;
  }
  std::string Content(const std::string& name) const { return ReadFile(folder_.path() / name); }

  TemporaryDirectory folder_;
};

TEST_F(TerminalTest, JointsOfColumnsBecomeAMapWithWhichItGoesOn) {
  WriteSensors("three.csv", 3);
  const ProgramResult result =
      Inspect({"three.csv"}, "ring_pip - index_mpc\nring_pip, -, index_mcp\n").Wait();
  EXPECT_EQ(result.exit_code, 0) << result.standard_error;
  EXPECT_THAT(result.standard_error,
              HasSubstr("unknown joint index_mpc (did you mean index_mcp?)"));
  EXPECT_THAT(result.standard_error, HasSubstr("wrote three.map.csv\r\n"));
  // Standard output has the result alone.
  EXPECT_THAT(result.standard_output, testing::StartsWith("2 sensors, 50 Hz, counts\n"));
  EXPECT_THAT(result.standard_output, HasSubstr("joints  2 by map\n"));
  EXPECT_THAT(result.standard_output,
              EndsWith("Next: gauntlet compare three.csv --map three.map.csv\n"));

  const auto found = nlohmann::json::parse(
      Inspect({"three.csv", "--map", "three.map.csv", "--json"}, "", false).Wait().standard_output);
  EXPECT_EQ(found["columns"][1]["channel"], "ring_pip");
  EXPECT_FALSE(found["columns"][2].contains("channel"));
  EXPECT_EQ(found["columns"][3]["channel"], "index_mcp");
}

TEST_F(TerminalTest, EachWrongAnswerIsOneLineAndTheQuestionAgain) {
  WriteSensors("three.csv", 3);
  const ProgramResult result =
      Inspect({"three.csv"}, "ring_pip\nring_pip ring_pip -\n- - -\n1\n\n").Wait();
  EXPECT_EQ(result.exit_code, 2);
  for (const std::string line : {"\n> 1 joint for 3 columns; - for a column without a joint\r\n",
                                 "\n> ring_pip appears twice\r\n", "\n> no column has a joint\r\n",
                                 "\n> no profile has this number of sensors\r\n"}) {
    EXPECT_THAT(result.standard_error, HasSubstr(line));
  }
  EXPECT_EQ(Names(), std::vector<std::string>{"three.csv"});
}

TEST_F(TerminalTest, AProfileOfTheListIsItsPreset) {
  WriteSensors("bytes.csv", 22);
  const ProgramResult result =
      Inspect({"bytes.csv", "--write-map", "answer.csv", "--write-scenario", "bytes.yaml"},
              "2\n1\n")
          .Wait();
  EXPECT_EQ(result.exit_code, 0) << result.standard_error;
  EXPECT_THAT(result.standard_error, HasSubstr("  1  cyberglove22  CyberGlove"));
  EXPECT_THAT(result.standard_error,
              HasSubstr("\n> 2 is no profile of the list, must be from 1 to 1"));
  ASSERT_EQ(
      Inspect({"bytes.csv", "--preset", "cyberglove22", "--write-map", "preset.csv"}, "", false)
          .Wait()
          .exit_code,
      0);
  EXPECT_EQ(Content("answer.csv"), Content("preset.csv"));
  EXPECT_THAT(Content("bytes.yaml"), HasSubstr("map: \"answer.csv\""));
}

TEST_F(TerminalTest, WithoutAnAnswerItEndsAsInAPipe) {
  WriteSensors("three.csv", 3);
  const std::vector<std::string> command = {"three.csv", "--write-map", "map.csv"};
  const ProgramResult in_pipe = Inspect(command, "ring_pip - -\n", false).Wait();
  EXPECT_EQ(in_pipe.exit_code, 2);
  EXPECT_THAT(in_pipe.standard_error, Not(HasSubstr(kPrompt)));
  const std::string map = Content("map.csv");
  EXPECT_THAT(map, HasSubstr("glove_q0,ignore,"));
  for (const std::string typed : {"\n", "\x04"}) {
    fs::remove(folder_.path() / "map.csv");
    const ProgramResult result = Inspect(command, typed).Wait();
    EXPECT_EQ(result.exit_code, 2);
    EXPECT_THAT(result.standard_error, HasSubstr(kPrompt));
    EXPECT_THAT(result.standard_error, HasSubstr("fill in map.csv, then --map map.csv\r\n"));
    EXPECT_EQ(result.standard_output, in_pipe.standard_output);
    EXPECT_EQ(Content("map.csv"), map);
  }
}

TEST_F(TerminalTest, CtrlCEndsItAtOnceWithoutAFile) {
  WriteSensors("three.csv", 3);
  Program program = Inspect({"three.csv", "--write-map", "map.csv"}, "");
  ASSERT_TRUE(program.WaitForText(kPrompt));
  program.Type("ring_pip \x03");
  const ProgramResult& result = program.Wait();
  EXPECT_EQ(result.exit_code, 130) << result.signal;
  EXPECT_THAT(result.standard_error,
              HasSubstr("gauntlet: interrupted; nothing half-written was left\r\n"));
  EXPECT_EQ(Names(), std::vector<std::string>{"three.csv"});
}

TEST_F(TerminalTest, NothingIsAskedWhereAnAnswerWouldBeLost) {
  WriteSensors("three.csv", 3);
  EXPECT_THAT(Inspect({"three.csv", "--json"}, "ring_pip - -\n").Wait().standard_error,
              Not(HasSubstr(kPrompt)));
  std::ofstream(folder_.path() / "three.map.csv") << "column,channel\n2,ring_pip\n";
  const ProgramResult result = Inspect({"three.csv"}, "ring_pip - -\n").Wait();
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.standard_error, Not(HasSubstr(kPrompt)));
  EXPECT_THAT(result.standard_error, HasSubstr("three.map.csv: was edited"));
  EXPECT_THAT(result.standard_error, HasSubstr("--map three.map.csv uses it\r\n"));
  EXPECT_EQ(Content("three.map.csv"), "column,channel\n2,ring_pip\n");
}

TEST_F(TerminalTest, JointsAreNoAnswerToAQuestionAboutTheUnit) {
  std::ofstream file(folder_.path() / "large.csv");
  file << "time_s,index_mcp_rad,middle_mcp_rad\n";
  for (int k = 0; k < 300; ++k) {
    file << 0.02 * k << "," << 40.0 + 30.0 * sin(0.05 * k) << "," << 40.0 + 30.0 * cos(0.05 * k)
         << "\n";
  }
  file.close();
  const ProgramResult result = Inspect({"large.csv"}, "index_mcp middle_mcp\n").Wait();
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.standard_error, Not(HasSubstr(kPrompt)));
}

}  // namespace
}  // namespace gauntlet::test
