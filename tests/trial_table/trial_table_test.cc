// Trials of comparisons and sweeps go through one table: the same locks, seals and full disks.
#include "sim/study/trial_table/trial_table.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <thread>

#include "sim/base/error.h"
#include "sim/study/trial_table/sweep_database.h"
#include "tests/support/program.h"
#include "tests/trial_table/failing_disk.h"

namespace gauntlet::sim {
namespace {

namespace fs = std::filesystem;
using std::chrono_literals::operator""ms;
using testing::EndsWith;
using testing::HasSubstr;

std::string SealOf(const TrialKey& key, const TrialOutcome& outcome,
                   const std::vector<std::size_t>& metrics) {
  std::string seal =
      key.study + key.controller + key.settings + std::to_string(key.seed) + outcome.health.problem;
  for (const std::size_t metric : metrics) {
    seal += " " + std::to_string(outcome.scores.summary[metric]);
  }
  return seal;
}

/// Parts that a comparison keeps, or a sweep.
TrialTableOptions Parts(bool comparison, std::chrono::milliseconds between_writes = 0ms) {
  TrialTableOptions options = {
      .kept_for = "test", .metrics = {0, 4}, .checksum = SealOf, .between_writes = between_writes};
  if (comparison) {
    options.rows = {"index_mcp", "index_pip"};
    options.channels = {"index_mcp"};
  }
  return options;
}

TrialKey KeyOf(int seed) { return {"study", "raw", "settings", seed}; }

TrialOutcome OutcomeOf(double score, const TrialTableOptions& parts) {
  TrialOutcome outcome;
  outcome.scores.summary.assign(Metrics().size(), std::numeric_limits<double>::quiet_NaN());
  outcome.scores.summary[4] = score;
  outcome.scores.channels.assign(parts.rows.size(), outcome.scores.summary);
  outcome.untrusted_samples.assign(parts.channels.size(), 7);
  return outcome;
}

class EachTrialTable : public testing::TestWithParam<bool> {
 protected:
  std::string ProblemOfKeeping(TrialTable& table, int seed) const {
    try {
      table.Keep(KeyOf(seed), OutcomeOf(seed, parts_));
    } catch (const RunError& error) {
      return error.what();
    }
    return "";
  }

  test::TemporaryDirectory folder_;
  fs::path file_ = folder_.path() / "study.db";
  const TrialTableOptions parts_ = Parts(GetParam());
};
INSTANTIATE_TEST_SUITE_P(Kinds, EachTrialTable, testing::Bool(),
                         [](const auto& kind) { return kind.param ? "comparison" : "sweep"; });

TEST_P(EachTrialTable, GivesBackItsPartsOfEverySeed) {
  {
    TrialTable table(file_, parts_);
    for (const int seed : {3, 5, 9}) table.Keep(KeyOf(seed), OutcomeOf(seed, parts_));
    EXPECT_EQ(table.added(), 3);
    table.Keep(KeyOf(5), OutcomeOf(6, parts_));
    EXPECT_EQ(table.added(), 3);  // replaced
  }
  TrialTable table(file_, parts_);
  const auto trials = table.Read(KeyOf(3), 4);
  ASSERT_EQ(trials.size(), 4u);
  EXPECT_TRUE(trials[0] && !trials[1] && trials[2] && !trials[3]);
  EXPECT_EQ(trials[0]->scores.summary[4], 3.0);
  EXPECT_TRUE(std::isnan(trials[0]->scores.summary[0]));
  EXPECT_EQ(trials[2]->scores.summary[4], 6.0);
  EXPECT_EQ(trials[2]->scores.channels.size(), parts_.rows.size());
  for (const auto& row : trials[2]->scores.channels) EXPECT_EQ(row[4], 6.0);
  EXPECT_EQ(trials[2]->untrusted_samples, OutcomeOf(0, parts_).untrusted_samples);
}

TEST_P(EachTrialTable, CountsADamagedTrialOnceAndRemovesIt) {
  TrialTable(file_, parts_).Keep(KeyOf(1), OutcomeOf(1, parts_));
  SQLite::Database(file_.string(), SQLite::OPEN_READWRITE).exec("UPDATE score SET value = 2");
  {
    TrialTable table(file_, parts_);
    for (int i = 0; i < 2; ++i) EXPECT_FALSE(table.Read(KeyOf(1), 1).front());
    EXPECT_EQ(table.damaged(), 1);
    table.Keep(KeyOf(2), OutcomeOf(2, parts_));
  }
  EXPECT_EQ(SQLite::Database(file_.string()).execAndGet("SELECT count(*) FROM trial").getInt(), 1);
  EXPECT_EQ(TrialTable(file_, parts_).Read(KeyOf(1), 2)[1]->scores.summary[4], 2.0);
}

TEST_P(EachTrialTable, WaitsForLocksAgainAfterAFullDisk) {
  TrialTable table(file_, parts_);
  {
    const test::FailingCall failing(test::kWrite, test::NoSpace);
    EXPECT_EQ(ProblemOfKeeping(table, 1),
              file_.string() +
                  ": the disk is full; the same command continues from the trials that are kept");
  }
  SQLite::Database other(file_.string(), SQLite::OPEN_READWRITE);
  other.exec("BEGIN EXCLUSIVE");
  EXPECT_EQ(ProblemOfKeeping(table, 2), "");  // at once
  std::jthread reader([&other] {
    std::this_thread::sleep_for(200ms);
    other.exec("ROLLBACK");
  });
  EXPECT_EQ(table.Finish(), std::nullopt);
  EXPECT_EQ(table.added(), 2);
}

TEST_P(EachTrialTable, SaysWhatTheFileLacksAndAddsItLater) {
  TrialTableOptions impatient = parts_;
  impatient.patience = 0ms;
  TrialTable table(file_, impatient);
  SQLite::Database other(file_.string(), SQLite::OPEN_READWRITE);
  other.exec("BEGIN EXCLUSIVE");
  for (const int seed : {1, 2}) EXPECT_EQ(ProblemOfKeeping(table, seed), "");
  EXPECT_EQ(table.Finish(), file_.string() +
                                ": lacks 2 trials of this test: another program (or its network "
                                "folder) keeps it locked; the same command adds them");
  other.exec("ROLLBACK");
  EXPECT_EQ(table.Finish(), std::nullopt);
  EXPECT_EQ(table.Read(KeyOf(1), 2)[1]->scores.summary[4], 2.0);
}

TEST_P(EachTrialTable, LeavesNoFileWithoutATrial) {
  TrialTable(file_, parts_);
  EXPECT_TRUE(fs::is_empty(folder_.path()));
  {
    const test::FailingCall failing(test::kWrite, test::NoSpace);
    EXPECT_THROW(TrialTable(file_, parts_), RunError);
    EXPECT_TRUE(fs::is_empty(folder_.path()));
  }
  {
    TrialTable table(file_, parts_);
    const test::FailingCall failing(test::kWrite, test::NoSpace);
    EXPECT_NE(ProblemOfKeeping(table, 1), "");
  }
  EXPECT_TRUE(fs::exists(file_));  // there was room again in the end
}

TEST(SweepFile, IsRemovedWithoutATrialAndStaysWithACell) {
  const test::TemporaryDirectory folder;
  const fs::path file = folder.path() / "study.db";
  SweepDatabase(file, "sweep", {0}).AddStudy("study", "");
  EXPECT_TRUE(fs::is_empty(folder.path()));
  {
    const test::FailingCall failing(test::kWrite, test::NoSpace);
    EXPECT_THROW(SweepDatabase(file, "sweep", {0}), RunError);
    EXPECT_TRUE(fs::is_empty(folder.path()));
  }
  SweepCellRecord cell;
  cell.problem = "cannot be built";
  SweepDatabase(file, "sweep", {0}).AddCell(cell, {{"key", "value"}});
  EXPECT_EQ(SweepDatabase(file, "sweep", {0}).CellAt(0).front().problem, "cannot be built");
}

TEST(SweepFile, IsRefusedAsALinkAlsoToBeCollected) {
  const test::TemporaryDirectory folder;
  const fs::path file = folder.path() / "study.db";
  const fs::path link = folder.path() / "link.db";
  const auto problem = [](const auto& work) -> std::string {
    try {
      work();
    } catch (const UserError& error) {
      return error.what();
    }
    return "";
  };
  fs::create_symlink(folder.path() / "nowhere", link);
  EXPECT_THAT(problem([&] { SweepDatabase(link, "sweep", {0}); }),
              HasSubstr("link.db: is a symbolic link; remove it"));
  EXPECT_FALSE(fs::exists(folder.path() / "nowhere"));
  SweepDatabase database(file, "sweep", {0});
  database.AddCell({}, {});
  fs::remove(link);
  fs::create_symlink(file, link);
  for (const fs::path& other : {link, folder.path()}) {
    EXPECT_EQ(problem([&] { database.Collect(other); }),
              "--collect: " + other.string() + ": must be a file, not a link or a device");
  }
  EXPECT_THAT(problem([&] { database.Collect(folder.path() / "none.db"); }),
              EndsWith("none.db: there is no such file"));
}

// The seal of sweeps is FNV-1a over the key's lines and the bytes of the scores: any other would
// run again what earlier versions kept.
TEST(SweepFile, HasTheSealOfEarlierVersions) {
  const test::TemporaryDirectory folder;
  const fs::path file = folder.path() / "study.db";
  TrialOutcome outcome;
  outcome.scores.summary.assign(Metrics().size(), 0.25);
  SweepDatabase(file, "sweep", {0, 1}).Keep({"study", "raw", "settings", 3}, outcome);
  EXPECT_EQ(SQLite::Database(file.string()).execAndGet("SELECT checksum FROM trial").getString(),
            "31e96ab76daa35fe");
}

}  // namespace
}  // namespace gauntlet::sim
