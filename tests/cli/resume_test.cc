// A comparison that was stopped goes on where it stopped, and ends with the same bytes.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <random>
#include <sstream>
#include <thread>

#include "tests/support/program.h"
#include "tests/support/source_dir.h"

namespace gauntlet::test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

std::string ReadFile(const fs::path& file) {
  std::ostringstream text;
  text << std::ifstream(file, std::ios::binary).rdbuf();
  return text.str();
}

class ResumeTest : public testing::Test {
 protected:
  std::vector<std::string> Command(const std::string& out, int seeds = 4) const {
    return {GAUNTLET_PROGRAM,
            "compare",
            SourceDir() + "/scenarios/hold_still.yaml",
            "--seeds",
            std::to_string(seeds),
            "--controllers",
            "raw,tuned_kalman",
            "--set",
            "glove.motion.duration_s=1.2",
            "--out",
            out};
  }
  ProgramResult Run(const std::string& out, const std::vector<std::string>& more = {}) {
    std::vector<std::string> command = Command(out);
    command.insert(command.end(), more.begin(), more.end());
    return RunProgram(command, {.working_directory = folder_.path()});
  }
  fs::path Out(const std::string& name) const { return folder_.path() / name; }
  void ExpectSameFiles(const std::string& a, const std::string& b) const {
    for (const char* name :
         {"scores.json", "scores.csv", "trace.h5", "report.html", "scenario.resolved.yaml"}) {
      EXPECT_TRUE(ReadFile(Out(a) / name) == ReadFile(Out(b) / name)) << name;
    }
    for (const auto& entry : fs::directory_iterator(Out(b))) {
      EXPECT_TRUE(fs::exists(Out(a) / entry.path().filename())) << entry.path();
    }
  }

  TemporaryDirectory folder_;
};

TEST_F(ResumeTest, KilledAtThirtyRandomMomentsItEndsWithTheSameBytes) {
  const auto start = std::chrono::steady_clock::now();
  ASSERT_EQ(Run("undisturbed").exit_code, 0);
  const std::chrono::duration<double> whole = std::chrono::steady_clock::now() - start;

  std::mt19937 random(20261121);  // moments only; no result depends on them
  for (int round = 0; round < 6; ++round) {
    const std::string out = "killed_" + std::to_string(round);
    for (int kill = 0; kill < 5; ++kill) {
      Program program(Command(out), {.working_directory = folder_.path()});
      std::this_thread::sleep_for(whole * (static_cast<double>(random() % 1000) / 1000.0));
      program.SendSignal(SIGKILL);
      program.Wait();
    }
    const ProgramResult last = Run(out);
    ASSERT_EQ(last.exit_code, 0) << last.standard_error;
    // What a killed program was writing has names of its own, which the next one takes away.
    ExpectSameFiles("undisturbed", out);
  }
}

TEST_F(ResumeTest, TellsWhatIsKeptAndGoesOnFromIt) {
  ASSERT_EQ(Run("a").exit_code, 0);
  fs::remove(Out("a") / "scores.json");
  const ProgramResult again = Run("a");
  EXPECT_EQ(again.exit_code, 0);
  EXPECT_THAT(again.standard_error, HasSubstr("goes on from a/study.db, which holds 8 trials"));
  EXPECT_TRUE(fs::exists(Out("a") / "scores.json"));
}

TEST_F(ResumeTest, MoreSeedsAddToThoseThatAreThere) {
  ASSERT_EQ(RunProgram(Command("few", 2), {.working_directory = folder_.path()}).exit_code, 0);
  const ProgramResult more = Run("few");
  EXPECT_THAT(more.standard_error, HasSubstr("which holds 4 trials"));
  ASSERT_EQ(Run("all").exit_code, 0);
  ExpectSameFiles("all", "few");
}

TEST_F(ResumeTest, TrialsOfOtherSettingsDoNotCount) {
  ASSERT_EQ(Run("a").exit_code, 0);
  const std::vector<std::string> other = {"--set", "hand.cable.capstan_friction=0.2"};
  const ProgramResult changed = Run("a", other);
  EXPECT_THAT(changed.standard_error, testing::Not(HasSubstr("goes on from")));
  ASSERT_EQ(Run("fresh", other).exit_code, 0);
  ExpectSameFiles("fresh", "a");
  // They stay, and are found again when the setting is changed back.
  EXPECT_THAT(Run("a").standard_error, HasSubstr("goes on from"));
  ASSERT_EQ(Run("first").exit_code, 0);
  ExpectSameFiles("first", "a");
}

TEST_F(ResumeTest, AFileThatIsNoDatabaseIsAClearLine) {
  fs::create_directory(Out("a"));
  std::ofstream(Out("a") / "study.db") << std::string(5000, 'x');
  const ProgramResult result = Run("a");
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.standard_error, HasSubstr("a/study.db: file is not a database; remove it"));
  EXPECT_EQ(ReadFile(Out("a") / "study.db"), std::string(5000, 'x'));
}

}  // namespace
}  // namespace gauntlet::test
