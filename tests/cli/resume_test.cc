// A comparison that was stopped goes on where it stopped, and ends with the same bytes.
#include <SQLiteCpp/SQLiteCpp.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <random>
#include <thread>

#include "tests/support/long_test.h"
#include "tests/support/program.h"
#include "tests/support/read_file.h"
#include "tests/support/source_dir.h"

namespace gauntlet::test {
namespace {

namespace fs = std::filesystem;
using testing::ContainsRegex;
using testing::HasSubstr;

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
  GAUNTLET_LONG_TEST();
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

TEST_F(ResumeTest, DamagedTrialsAreComputedAgainAndTold) {
  ASSERT_EQ(Run("undisturbed").exit_code, 0);
  fs::copy(Out("undisturbed"), Out("a"));
  SQLite::Database(Out("a") / "study.db", SQLite::OPEN_READWRITE)
      .exec(
          "UPDATE score SET value = value + 1 WHERE metric = 'delay_ms' OR metric = 'sparc' OR "
          "trial IN (SELECT id FROM trial WHERE seed = 2)");
  const ProgramResult result = Run("a");
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_THAT(result.standard_error, HasSubstr("a/study.db: 2 trials damaged, computed again\n"));
  ExpectSameFiles("undisturbed", "a");
  EXPECT_THAT(Run("a").standard_error, HasSubstr("with 8 trials"));
}

TEST_F(ResumeTest, ADatabaseThatTakesNoTrialCostsNoResult) {
  GAUNTLET_LONG_TEST();
  ASSERT_EQ(Run("undisturbed").exit_code, 0);
  ASSERT_EQ(RunProgram(Command("a", 2), {.working_directory = folder_.path()}).exit_code, 0);
  SQLite::Database database(Out("a") / "study.db", SQLite::OPEN_READWRITE);
  database.exec(
      "CREATE TRIGGER full BEFORE INSERT ON trial WHEN new.seed > 2 "
      "BEGIN SELECT RAISE(ABORT, 'no more'); END");
  const ProgramResult result = Run("a");
  EXPECT_EQ(result.exit_code, 1);
  // The trials of the first seed run each time. On a slow machine they are written beforehand.
  EXPECT_THAT(result.standard_error,
              ContainsRegex("a/study.db: lacks [456] trials of this comparison: no more; the same "
                            "command adds them\n"));
  ExpectSameFiles("undisturbed", "a");
  database.exec("DROP TRIGGER full");
  EXPECT_EQ(Run("a").exit_code, 0);
  EXPECT_THAT(Run("a").standard_error, HasSubstr("with 8 trials"));
}

TEST_F(ResumeTest, AReaderDoesNotEndAComparison) {
  ASSERT_EQ(Run("undisturbed").exit_code, 0);
  ASSERT_EQ(RunProgram(Command("a", 2), {.working_directory = folder_.path()}).exit_code, 0);
  SQLite::Database reader(Out("a") / "study.db");
  reader.exec("BEGIN");
  EXPECT_EQ(reader.execAndGet("SELECT count(*) FROM trial").getInt(), 4);
  Program program(Command("a"), {.working_directory = folder_.path()});
  ASSERT_TRUE(program.WaitForText("continues from"));
  std::this_thread::sleep_for(std::chrono::milliseconds(500));  // of a few trials; any time will do
  reader.exec("COMMIT");
  EXPECT_EQ(program.Wait().exit_code, 0) << program.Wait().standard_error;
  ExpectSameFiles("undisturbed", "a");
  EXPECT_EQ(reader.execAndGet("SELECT count(*) FROM trial").getInt(), 8);
}

// With two trials at a time the last controllers of a seed begin while the next seed is looked up.
TEST_F(ResumeTest, AControllerThatIsAddedRunsAloneOfAllSeedsButTheFirst) {
  const auto compare = [this](const std::string& controllers) {
    std::vector<std::string> command = Command("a");
    std::ranges::replace(command, std::string("raw,tuned_kalman"), controllers);
    command.insert(command.end(), {"--jobs", "2"});
    return RunProgram(command, {.working_directory = folder_.path()});
  };
  ASSERT_EQ(compare("raw,mean_20,tuned_kalman").exit_code, 0);
  SQLite::Database database(Out("a") / "study.db");
  const auto rows_of_later_seeds = [&] {
    return database
        .execAndGet(
            "SELECT group_concat(id) FROM (SELECT id FROM trial WHERE seed > 1 AND "
            "controller <> 'paper_kalman' ORDER BY id)")
        .getString();
  };
  const std::string before = rows_of_later_seeds();
  ASSERT_EQ(compare("raw,mean_20,paper_kalman,tuned_kalman").exit_code, 0);
  EXPECT_EQ(rows_of_later_seeds(), before);
  EXPECT_EQ(database.execAndGet("SELECT count(*) FROM trial").getInt(), 4 * 4);
}

}  // namespace
}  // namespace gauntlet::test
