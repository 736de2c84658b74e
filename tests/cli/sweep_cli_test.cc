// gauntlet sweep from the outside: stopped and killed, in shards, and with mistakes.
#include <SQLiteCpp/SQLiteCpp.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <random>
#include <thread>

#include "tests/support/program.h"
#include "tests/support/read_file.h"
#include "tests/support/source_dir.h"

namespace gauntlet::test {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;

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

TEST_F(SweepCommandTest, TellsItsTimeAndThenTheBestCells) {
  const ProgramResult result = Sweep({"--jobs", "2"});
  ASSERT_EQ(result.exit_code, 0) << result.standard_error;
  EXPECT_THAT(result.standard_error, AllOf(HasSubstr("6 cells x 2 seeds: 11 trials to run"),
                                           HasSubstr("with 2 at a time")));
  EXPECT_THAT(
      result.standard_output,
      AllOf(HasSubstr("best by tracking_rmse_deg"), HasSubstr("6 of 6 keep peak_error_deg<=90"),
            HasSubstr("gauntlet compare"), HasSubstr("--set 'event.delay_ms=")));
  const ProgramResult json = Sweep({"--json"});
  ASSERT_EQ(json.exit_code, 0) << json.standard_error;
  const auto parsed = nlohmann::json::parse(json.standard_output);
  EXPECT_EQ(parsed["scenario"], "scenarios/hold_still.yaml");
  EXPECT_EQ(parsed["cells"].size(), 6u);
  ASSERT_EQ(parsed["best"].size(), 6u);
  for (std::size_t i = 1; i < 6; ++i) {
    EXPECT_LE(parsed["best"][i - 1]["scores"]["tracking_rmse_deg"]["mean"],
              parsed["best"][i]["scores"]["tracking_rmse_deg"]["mean"]);
  }
  // Nothing was left to run.
  EXPECT_THAT(json.standard_error, testing::Not(HasSubstr("to run")));
  EXPECT_LT(fs::file_size(folder_.path() / "out/short/study.db"), 100'000u);
}

TEST_F(SweepCommandTest, StopsCellsThatCannotWinUnlessAllSeedsAreAskedFor) {
  const ProgramResult stopped = Sweep({"--seeds", "6", "--filter-only"});
  ASSERT_EQ(stopped.exit_code, 0) << stopped.standard_error;
  EXPECT_THAT(stopped.standard_error, HasSubstr("trials to run at most"));
  const ProgramResult all = Sweep({"--seeds", "6", "--filter-only", "--all-seeds"});
  ASSERT_EQ(all.exit_code, 0) << all.standard_error;
  EXPECT_THAT(all.standard_output, testing::Not(HasSubstr("stopped early")));
}

TEST_F(SweepCommandTest, KilledAtThirtyRandomMomentsItEndsWithTheSameBytes) {
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
  ASSERT_TRUE(program.WaitForText("goes on from"));
  std::this_thread::sleep_for(std::chrono::milliseconds(700));  // longer than all trials take
  other.exec("ROLLBACK");
  EXPECT_EQ(program.Wait().exit_code, 0) << program.Wait().standard_error;
  EXPECT_EQ(ReadFile("locked/cells.csv"), ReadFile("whole/cells.csv"));
  EXPECT_EQ(Trials("locked"), Trials("whole"));
}

TEST_F(SweepCommandTest, ShardsMakeTheSameAsOneMachine) {
  ASSERT_EQ(Sweep({"--out", "whole"}).exit_code, 0);
  ASSERT_EQ(Sweep({"--shard", "1/2"}).exit_code, 0);
  ASSERT_EQ(Sweep({"--shard", "2/2"}).exit_code, 0);
  const ProgramResult merged = Sweep({"--out", "merged", "--collect", "out/short.shard-1-of-2",
                                      "--collect", "out/short.shard-2-of-2"});
  ASSERT_EQ(merged.exit_code, 0) << merged.standard_error;
  EXPECT_THAT(merged.standard_error,
              AllOf(HasSubstr("collected 6 trials"), testing::Not(HasSubstr("to run"))));
  EXPECT_EQ(ReadFile("merged/cells.csv"), ReadFile("whole/cells.csv"));
  EXPECT_EQ(ReadFile("merged/report.html"), ReadFile("whole/report.html"));
  EXPECT_THAT(ReadFile("whole/report.html"), HasSubstr("class=\"heat-map\""));
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

TEST_F(SweepCommandTest, RefusesMistakesInOneLineBeforeAnythingRuns) {
  const auto mistake = [this](const std::vector<std::string>& more, const std::string& problem) {
    const ProgramResult result = Sweep(more);
    EXPECT_EQ(result.exit_code, 2) << result.standard_error;
    EXPECT_THAT(result.standard_error, HasSubstr(problem));
    EXPECT_EQ(std::ranges::count(result.standard_error, '\n'), 1) << result.standard_error;
    EXPECT_FALSE(fs::exists(folder_.path() / "out"));
  };
  mistake({"--max-cells", "5"}, "short.yaml: axes: make 6 cells, more than --max-cells 5");
  mistake({"--shard", "3/2"}, "--shard: 3/2: must be i/n");
  mistake({"--shard", "1/2x"}, "must be i/n");
  mistake({"--shard", "1/2", "--collect", "out"}, "contradict each other");
  mistake({"--set", "glove.nois=1"}, "unknown key");
  const std::string study = ReadFile("short.yaml");
  const std::size_t list = study.find("  - {key: event");
  std::ofstream(folder_.path() / "short.yaml")
      << study.substr(0, list)
      << "  - {key: event.delay_ms, low: 0.1, high: 0.9, whole: true}\ndesign: random\ncells: 3\n";
  mistake({}, "short.yaml:7:55: axes[0].whole: from 0.1 to 0.9 lies no whole number");
}

TEST_F(SweepCommandTest, RobustInShardsConcludesAsOneMachineDoes) {
  const auto robust = [this](const std::vector<std::string>& more) {
    std::vector<std::string> command = {GAUNTLET_PROGRAM,
                                        "robust",
                                        "hold_still",
                                        "--controllers",
                                        "raw,tuned_kalman",
                                        "--hands",
                                        "2",
                                        "--seeds",
                                        "2",
                                        "--set",
                                        "glove.motion.duration_s=0.2",
                                        "--set",
                                        "score.noise_free_twin=false"};
    command.insert(command.end(), more.begin(), more.end());
    return RunProgram(command, {.working_directory = folder_.path()});
  };
  const ProgramResult whole = robust({"--out", "whole", "--jobs", "2"});
  ASSERT_EQ(whole.exit_code, 0) << whole.standard_error;
  EXPECT_THAT(whole.standard_output,
              AllOf(HasSubstr("2 hands, each with friction"), HasSubstr("own hand"),
                    HasSubstr("What matters:"), HasSubstr("is best on the scenario's own hand")));
  for (const char* shard : {"1/2", "2/2"}) {
    const ProgramResult part = robust({"--shard", shard});
    ASSERT_EQ(part.exit_code, 0) << part.standard_error;
    EXPECT_EQ(part.standard_output, "");  // a part of the hands concludes nothing
  }
  const ProgramResult merged =
      robust({"--out", "merged", "--collect", "out/hold_still.robust.shard-1-of-2", "--collect",
              "out/hold_still.robust.shard-2-of-2"});
  ASSERT_EQ(merged.exit_code, 0) << merged.standard_error;
  EXPECT_THAT(merged.standard_error, testing::Not(HasSubstr("to run")));
  EXPECT_EQ(merged.standard_output, whole.standard_output);
  EXPECT_THAT(ReadFile("whole/report.html"), HasSubstr("class=\"tornado\""));
  for (const char* file : {"robust.csv", "tornado.csv", "cells.csv"}) {
    EXPECT_EQ(ReadFile(fs::path("merged") / file), ReadFile(fs::path("whole") / file)) << file;
  }
}

TEST_F(SweepCommandTest, ReadyStudiesCanBeRead) {
  for (const auto& entry : fs::directory_iterator(fs::path(SourceDir()) / "studies")) {
    const ProgramResult result = RunProgram(
        {GAUNTLET_PROGRAM, "sweep", entry.path().string(), "--max-cells", "1", "--out", "none"},
        {.working_directory = folder_.path()});
    EXPECT_THAT(result.standard_error, HasSubstr("more than --max-cells 1")) << entry.path();
  }
}

}  // namespace
}  // namespace gauntlet::test
