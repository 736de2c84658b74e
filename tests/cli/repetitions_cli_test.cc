// Repetitions from the command line: how many seeds, which trial a seed is, and the same bytes
// however the way to them was.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <sstream>

#include "tests/support/program.h"
#include "tests/support/read_file.h"

namespace gauntlet::test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class RepetitionsCliTest : public testing::Test {
 protected:
  RepetitionsCliTest() {
    std::ofstream(folder_.path() / "s.yaml")
        << "question: Which?\nseed: 2\nglove:\n  rate_hz: 33.3\n  channels: [index_pip, ring_pip]\n"
           "  faults: spikes\n"
           "repetitions:\n  glove.motion:\n"
           "    - {kind: hold, duration_s: 0.2}\n"
           "    - {kind: random, duration_s: 0.25}\n"
           "    - {kind: steps, duration_s: 0.3}\n"
           "controllers:\n  mean:\n    filter: {kind: moving_average, window: 2}\n"
           "  median:\n    filter: {kind: median, window: 3}\n";
  }
  ProgramResult Run(std::vector<std::string> arguments) const {
    arguments.insert(arguments.begin(), GAUNTLET_PROGRAM);
    return RunProgram(arguments, {.working_directory = folder_.path()});
  }
  void ExpectSameFiles(const std::string& a, const std::string& b) const {
    for (const char* name :
         {"scores.json", "scores.csv", "trace.h5", "report.html", "scenario.resolved.yaml"}) {
      EXPECT_TRUE(ReadFile(folder_.path() / a / name) == ReadFile(folder_.path() / b / name))
          << name;
    }
  }
  /// The lines of a table of scores that are of this seed.
  std::string ScoresOf(const std::string& folder, int seed) const {
    std::istringstream table(ReadFile(folder_.path() / folder / "scores.csv"));
    std::string found;
    for (std::string line; std::getline(table, line);) {
      if (line.starts_with(std::to_string(seed) + ",")) found += line + "\n";
    }
    return found;
  }

  TemporaryDirectory folder_;
};

TEST_F(RepetitionsCliTest, MoreSeedsAndMoreThreadsGiveTheSameBytes) {
  ASSERT_EQ(Run({"compare", "s.yaml", "--seeds", "7", "--jobs", "1", "--out", "all"}).exit_code, 0);
  ASSERT_EQ(Run({"compare", "s.yaml", "--seeds", "4", "--jobs", "2", "--out", "few"}).exit_code, 0);
  const ProgramResult more = Run({"compare", "s.yaml", "--seeds", "7", "--out", "few"});
  EXPECT_THAT(more.standard_error, HasSubstr("which holds 8 trials"));
  EXPECT_THAT(more.standard_output,
              HasSubstr("0.2 to 0.3 s, 2 of 18 joints measured; seeds 2 to 8: "));
  ExpectSameFiles("all", "few");
}

TEST_F(RepetitionsCliTest, ARunOfASeedIsTheTrialOfTheComparison) {
  ASSERT_EQ(Run({"compare", "s.yaml", "--seeds", "5", "--out", "all"}).exit_code, 0);
  for (const int seed : {2, 4, 6}) {
    const std::string name = "run" + std::to_string(seed);
    ASSERT_EQ(Run({"run", "s.yaml", "--seed", std::to_string(seed), "--out", name}).exit_code, 0);
    EXPECT_NE(ScoresOf(name, seed), "");
    EXPECT_EQ(ScoresOf(name, seed), ScoresOf("all", seed));
    ASSERT_EQ(Run({"run", name + "/scenario.resolved.yaml", "--out", name + "b"}).exit_code, 0);
    ExpectSameFiles(name, name + "b");
  }
  ASSERT_EQ(
      Run({"compare", "all/scenario.resolved.yaml", "--seeds", "5", "--out", "again"}).exit_code,
      0);
  ExpectSameFiles("all", "again");
}

TEST_F(RepetitionsCliTest, EveryRepetitionComesOnceByDefault) {
  const ProgramResult three = Run({"compare", "s.yaml", "--out", "three"});
  EXPECT_THAT(three.standard_output, HasSubstr("seeds 2 to 9: 5 motions, 1 to 3 noises\neach;"));
  const ProgramResult ten =
      Run({"compare", "s.yaml", "--out", "ten", "--set",
           "repetitions={glove.noise.variance_scale: [1, 2, 3, 4, 5, 6, 7, 8, 9, 10]}", "--set",
           "glove.motion={kind: hold, duration_s: 0.2}"});
  EXPECT_THAT(ten.standard_output, HasSubstr("seeds 2 to 11: one motion, 10 noises;"));
  EXPECT_THAT(Run({"compare", "--help"}).standard_output,
              HasSubstr("[8, or one for each repetition]"));
}

TEST_F(RepetitionsCliTest, AMissingRecordingOfAnyRepetitionIsFoundBeforeTheFirstTrial) {
  const ProgramResult result =
      Run({"compare", "s.yaml", "--out", "none", "--set",
           "repetitions={glove.motion: [{kind: hold}, {kind: recording, file: gone.csv}]}"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.standard_error, HasSubstr("gone.csv"));
  EXPECT_FALSE(fs::exists(folder_.path() / "none"));
}

TEST_F(RepetitionsCliTest, DiffNamesTheListsThatDiffer) {
  ASSERT_EQ(Run({"run", "s.yaml", "--out", "a"}).exit_code, 0);
  ASSERT_EQ(Run({"run", "s.yaml", "--set", "repetitions={}", "--out", "b"}).exit_code, 0);
  EXPECT_THAT(Run({"diff", "a", "b"}).standard_output,
              HasSubstr("repetitions.glove.motion.1.kind"));
}

}  // namespace
}  // namespace gauntlet::test
