// gauntlet sweep from the outside: stopped and killed, in shards, and with mistakes.
#include <SQLiteCpp/SQLiteCpp.h>
#include <gtest/gtest.h>

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

class SweepCommandTest : public testing::Test {
 protected:
  SweepCommandTest() {
    std::ofstream(folder_.path() / "short.yaml")
        << "question: Which noise is best for a slow link?\n"
           "scenario: " +
               SourceDir() +
               "/scenarios/hold_still.yaml\n"
               "set: [glove.motion.duration_s=0.3, score.noise_free_twin=false]\n"
               "controllers: [tuned_kalman]\n"
               "seeds: 2\n"
               "axes:\n"
               "  - {key: event.delay_ms, values: [0, 40]}\n"
               "  - {key: controllers.tuned_kalman.filter.q, low: 1e-4, high: 1, count: 3, "
               "spacing: log}\n"
               "subject_to: [peak_error_deg<=90]\n";
  }

  ProgramResult Sweep(const std::vector<std::string>& more) const {
    return RunProgram(Command(more), {.working_directory = folder_.path()});
  }
  static std::vector<std::string> Command(const std::vector<std::string>& more) {
    std::vector<std::string> command = {GAUNTLET_PROGRAM, "sweep", "short.yaml"};
    command.insert(command.end(), more.begin(), more.end());
    return command;
  }
  std::string ReadFile(const fs::path& file) const { return test::ReadFile(folder_.path() / file); }

  /// How many trials the database of a folder holds.
  int Trials(const std::string& out) const {
    SQLite::Database database((folder_.path() / out / "study.db").string());
    return database.execAndGet("SELECT count(*) FROM trial").getInt();
  }

  TemporaryDirectory folder_;
};

TEST_F(SweepCommandTest, KilledAtThirtyRandomMomentsItEndsWithTheSameBytes) {
  GAUNTLET_LONG_TEST();
  const auto start = std::chrono::steady_clock::now();
  ASSERT_EQ(Sweep({"--filter-only", "--out", "whole"}).exit_code, 0);
  const std::chrono::duration<double> whole = std::chrono::steady_clock::now() - start;
  std::mt19937 random(20261122);  // moments only; no result depends on them
  for (int round = 0; round < 3; ++round) {
    const std::string out = "killed_" + std::to_string(round);
    for (int kill = 0; kill < 10; ++kill) {
      Program program(Command({"--filter-only", "--out", out}),
                      {.working_directory = folder_.path()});
      std::this_thread::sleep_for(whole * (static_cast<double>(random() % 1000) / 1000.0));
      program.SendSignal(SIGKILL);
      program.Wait();
    }
    ASSERT_EQ(Sweep({"--filter-only", "--out", out, "--jobs", "2"}).exit_code, 0);
    EXPECT_EQ(ReadFile(out + "/cells.csv"), ReadFile("whole/cells.csv"));
    EXPECT_EQ(ReadFile(out + "/report.html"), ReadFile("whole/report.html"));
    EXPECT_EQ(Trials(out), Trials("whole"));
  }
}

TEST_F(SweepCommandTest, ADatabaseThatAnotherProgramLocksOnlyWaits) {
  ASSERT_EQ(Sweep({"--filter-only", "--out", "whole"}).exit_code, 0);
  ASSERT_EQ(Sweep({"--filter-only", "--out", "locked", "--seeds", "1"}).exit_code, 0);
  SQLite::Database other((folder_.path() / "locked/study.db").string(), SQLite::OPEN_READWRITE);
  other.exec("BEGIN IMMEDIATE");  // it may be read, and nobody else writes
  Program program(Command({"--filter-only", "--out", "locked"}),
                  {.working_directory = folder_.path()});
  ASSERT_TRUE(program.WaitForText("continues from"));
  std::this_thread::sleep_for(std::chrono::milliseconds(700));  // longer than all trials take
  other.exec("ROLLBACK");
  EXPECT_EQ(program.Wait().exit_code, 0) << program.Wait().standard_error;
  EXPECT_EQ(ReadFile("locked/cells.csv"), ReadFile("whole/cells.csv"));
  EXPECT_EQ(Trials("locked"), Trials("whole"));
}

TEST_F(SweepCommandTest, ShardsThatAreKilledAndRepeatedLoseNothing) {
  ASSERT_EQ(Sweep({"--out", "whole"}).exit_code, 0);
  std::mt19937 random(7);  // moments only; no result depends on them
  for (int round = 0; round < 2; ++round) {
    Program first(Command({"--shard", "1/2"}), {.working_directory = folder_.path()});
    Program second(Command({"--shard", "2/2"}), {.working_directory = folder_.path()});
    for (Program* shard : {&first, &second}) {
      std::this_thread::sleep_for(std::chrono::milliseconds(random() % 200));
      shard->SendSignal(SIGKILL);
      shard->Wait();
    }
  }
  for (const char* shard : {"1/2", "2/2", "1/2"}) ASSERT_EQ(Sweep({"--shard", shard}).exit_code, 0);
  ASSERT_EQ(Sweep({"--out", "merged", "--collect", "out/short.shard-1-of-2", "--collect",
                   "out/short.shard-2-of-2"})
                .exit_code,
            0);
  EXPECT_EQ(ReadFile("merged/cells.csv"), ReadFile("whole/cells.csv"));
}

}  // namespace
}  // namespace gauntlet::test
