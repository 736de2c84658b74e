// Every place where a person writes a number reads the same texts.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <string>
#include <vector>

#include "tests/support/long_test.h"
#include "tests/support/program.h"
#include "tests/support/source_dir.h"

namespace gauntlet::test {
namespace {

using testing::HasSubstr;
using testing::Not;

class NumbersTest : public testing::Test {
 protected:
  NumbersTest() {
    std::ofstream(folder_.path() / "study.yaml")
        << "question: Which?\n"
           "scenario: " +
               hold_still_ +
               "\n"
               "controllers: [tuned_kalman]\n"
               "axes: [{key: event.delay_ms, values: [0, 40]}]\n";
  }
  /// The unknown key is found when every number has been read: nothing runs.
  void WriteScenario(const std::string& rate) const {
    std::ofstream(folder_.path() / "s.yaml")
        << "question: Which?\n"
           "glove:\n"
           "  rate_hz: "
        << rate
        << "\n"
           "  motion: {kind: random, duration_s: 4, bandwidth_hz: 1}\n"
           "controllers:\n"
           "  raw: {filter: none}\n"
           "unknown: 1\n";
  }
  void Check(const std::vector<std::string>& words, const std::string& text, bool is_number,
             const std::string& refusal, const std::string& next) const {
    std::vector<std::string> command = {GAUNTLET_PROGRAM};
    command.insert(command.end(), words.begin(), words.end());
    const ProgramResult result = RunProgram(command, {.working_directory = folder_.path()});
    EXPECT_EQ(result.exit_code, 2) << result.standard_error;
    EXPECT_THAT(result.standard_error, HasSubstr(is_number ? next : refusal)) << text;
    EXPECT_THAT(result.standard_error, Not(HasSubstr(is_number ? refusal : next)));
  }
  /// In an option, in a setting of an option, in a file, in a range and in a share.
  void CheckEverywhere(const std::string& text, bool is_number, bool is_whole) const {
    Check({"inspect", "none.csv", "--rate", text}, text, is_number,
          "--rate: is '" + text + "', must be a number from", "none.csv: no such file");
    WriteScenario("100");
    Check({"run", "s.yaml", "--set", "glove.rate_hz=" + text}, text, is_number,
          "is \"" + text + "\", must be a number", "unknown: unknown key");
    Check({"tune", hold_still_, "--controller", "tuned_kalman", "--free", "q=" + text + ":0"}, text,
          is_number, "\"" + text + "\" must be a number", "LOW must be below HIGH");
    Check({"run", "s.yaml", "--seed", text}, text, is_whole,
          "--seed: is '" + text + "', must be a whole number from", "unknown: unknown key");
    Check({"sweep", "study.yaml", "--collect", "none", "--shard", text + "/99"}, text, is_whole,
          text + "/99: must be i/n", "contradict each other");
    WriteScenario(text);
    Check({"run", "s.yaml"}, text, is_number, "is \"" + text + "\", must be a number",
          "unknown: unknown key");
  }

  const std::string hold_still_ = SourceDir() + "/scenarios/hold_still.yaml";
  TemporaryDirectory folder_;
};

TEST_F(NumbersTest, AreDecimalEverywhere) {
  GAUNTLET_LONG_TEST();
  for (const char* const text : {"12", "+12", "012", "12.0", "12.", ".12e2", "12e0"}) {
    CheckEverywhere(text, true, true);
  }
  CheckEverywhere("12.5", true, false);
  for (const char* const text : {"0x12", "0x1p4", "inf", "nan", ".inf", ".nan", "1e999", "12x",
                                 "12,5", "12e", "12e1.5", "+-12", "1_2", "twelve"}) {
    CheckEverywhere(text, false, false);
  }
}

TEST_F(NumbersTest, OfAnOptionAreDecimalAlsoWithALeadingZero) {
  const ProgramResult result =
      RunProgram({GAUNTLET_PROGRAM, "run", hold_still_, "--seed", "010", "--set",
                  "glove.motion.duration_s=2", "--controllers", "raw", "--json"},
                 {.working_directory = folder_.path()});
  EXPECT_EQ(result.exit_code, 0) << result.standard_error;
  EXPECT_THAT(result.standard_output, HasSubstr("\"seed\": 10")) << "not 8, as in C";
}

}  // namespace
}  // namespace gauntlet::test
