// Trials come back from the database bit by bit, and only to the study that they belong to. Locks,
// failing disks and damaged files cost time at most.
#include "sim/study/trial_table/study_database.h"

#include <SQLiteCpp/SQLiteCpp.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sqlite3.h>

#include <bit>
#include <cmath>
#include <csignal>
#include <fstream>
#include <limits>
#include <random>
#include <sstream>

#include "sim/base/error.h"
#include "sim/base/stop.h"
#include "tests/support/program.h"
#include "tests/trial_table/failing_disk.h"

namespace gauntlet::sim {
namespace {

namespace fs = std::filesystem;
using std::chrono_literals::operator""ms;
using test::FailingCall;
using test::kRead;
using test::kWrite;
using test::NoLocks;
using test::NoSpace;
using test::NothingTaken;
using test::NothingToRead;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

Study MakeStudy(const std::string& question, double duration_s) {
  Scenario scenario;
  scenario.name = "made_up";
  scenario.question = question;
  scenario.glove.motion.settings = HoldConfig{.duration_s = duration_s};
  scenario.controllers = {{.name = "raw", .config = {}}, {.name = "same", .config = {}}};
  return PrepareStudy(scenario);
}

TrialOutcome MakeOutcome(double offset = 0.0) {
  TrialOutcome outcome;
  for (std::size_t m = 0; m < Metrics().size(); ++m) {
    outcome.scores.summary.push_back(1.0 / 3.0 + static_cast<double>(m) + offset);
  }
  outcome.scores.summary[2] = std::numeric_limits<double>::quiet_NaN();
  outcome.scores.channels.assign(18 + 36, outcome.scores.summary);  // joints and motors, cables
  outcome.scores.channels[7][3] = -1e-300;
  outcome.untrusted_samples.assign(18, 0);
  outcome.untrusted_samples[4] = 1'000'000'000'000;
  return outcome;
}

bool SameBits(const std::vector<double>& a, const std::vector<double>& b) {
  return std::ranges::equal(a, b, [](double x, double y) {
    return std::bit_cast<std::uint64_t>(x) == std::bit_cast<std::uint64_t>(y);
  });
}

bool SameBits(const TrialOutcome& a, const TrialOutcome& b) {
  return a.untrusted_samples == b.untrusted_samples && a.health.problem == b.health.problem &&
         a.health.ok == b.health.ok && SameBits(a.scores.summary, b.scores.summary) &&
         std::ranges::equal(a.scores.channels, b.scores.channels,
                            [](const auto& x, const auto& y) { return SameBits(x, y); });
}

std::string ReadBytes(const fs::path& file) {
  std::ostringstream bytes;
  bytes << std::ifstream(file, std::ios::binary).rdbuf();
  return bytes.str();
}

class StudyDatabaseTest : public testing::Test {
 protected:
  StudyDatabase Open(const Study& study) { return {file_, study, {.seeds = 10, .patience = 50ms}}; }
  StudyDatabase Open() { return Open(study_); }
  void Execute(const std::string& sql) {
    SQLite::Database(file_.string(), SQLite::OPEN_READWRITE).exec(sql);
  }
  /// What is said when the file is opened.
  template <class Error>
  std::string OpeningSays() {
    try {
      Open();
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  }

  test::TemporaryDirectory folder_;
  fs::path file_ = folder_.path() / "study.db";
  Study study_ = MakeStudy("What is kept?", 0.5);
};

TEST_F(StudyDatabaseTest, GivesATrialBackBitByBit) {
  const TrialOutcome kept = MakeOutcome();
  Open().Keep(7, 1, kept);
  StudyDatabase database = Open();
  EXPECT_EQ(database.TrialCount(), 1);
  EXPECT_TRUE(database.Has(7, 1));
  EXPECT_TRUE(database.Has(7, 1));  // a look changes nothing
  const auto found = database.Take(7, 1);
  ASSERT_TRUE(found);
  EXPECT_TRUE(SameBits(*found, kept));
  EXPECT_FALSE(database.Has(7, 1));
  EXPECT_FALSE(database.Take(7, 1));
}

TEST_F(StudyDatabaseTest, KeepsWhyAHandStopped) {
  TrialOutcome outcome = MakeOutcome();
  outcome.health = {.ok = false, .problem = "at 1.5 s: diverged"};
  Open().Keep(1, 0, outcome);
  EXPECT_TRUE(SameBits(Open().Take(1, 0).value(), outcome));
}

TEST_F(StudyDatabaseTest, FindsNeitherOtherSeedsNorOtherControllers) {
  EXPECT_FALSE(Open().Take(7, 1));
  Open().Keep(7, 1, MakeOutcome());
  StudyDatabase database = Open();
  EXPECT_FALSE(database.Has(8, 1));
  EXPECT_FALSE(database.Take(8, 1));
  EXPECT_FALSE(database.Take(7, 0));  // of the same settings, but of another name
}

TEST_F(StudyDatabaseTest, ReadsNoMoreSeedsThanMayBeAskedFor) {
  Open().Keep(7, 1, MakeOutcome());
  StudyDatabase few(file_, study_, {.seeds = 6});
  EXPECT_FALSE(few.Take(7, 1));
  EXPECT_EQ(few.TrialCount(), 1);
}

TEST_F(StudyDatabaseTest, AnotherWordingIsTheSameStudyAnotherSettingIsNot) {
  Open().Keep(7, 1, MakeOutcome());
  const Study reworded = MakeStudy("Reworded?", 0.5);
  EXPECT_TRUE(Open(reworded).Take(7, 1));
  const Study longer = MakeStudy("What is kept?", 0.6);
  {
    StudyDatabase other = Open(longer);
    EXPECT_FALSE(other.Take(7, 1));
    other.Keep(1, 0, MakeOutcome());
  }
  EXPECT_EQ(Open(longer).TrialCount(), 1);
  EXPECT_EQ(Open().TrialCount(), 1);  // what other settings gave stays
  EXPECT_TRUE(Open().Take(7, 1));
}

TEST_F(StudyDatabaseTest, ShowsWhatWasAskedForLast) {
  Open().Keep(7, 0, MakeOutcome());
  Open().Keep(7, 1, MakeOutcome());
  Open(MakeStudy("What is kept?", 0.6)).Keep(7, 0, MakeOutcome());
  SQLite::Database database(file_.string());
  const auto count = [&](const std::string& view) {
    return database
        .execAndGet("SELECT count(*) FROM " + view +
                    " WHERE channel = 'summary' AND metric = 'delay_ms'")
        .getInt();
  };
  EXPECT_EQ(count("scores"), 1);
  EXPECT_EQ(count("all_scores"), 3);
  {
    StudyDatabase again = Open();
    again.Keep(8, 0, MakeOutcome());
    EXPECT_TRUE(again.Take(7, 0));
    EXPECT_FALSE(again.Finish());
    EXPECT_EQ(count("scores"), 2);  // of controller 1, kept before, nobody asked again
  }
  EXPECT_EQ(count("scores"), 2);
  EXPECT_EQ(count("all_scores"), 4);
}

TEST_F(StudyDatabaseTest, AControllerThatIsLeftOutKeepsItsTrials) {
  Open().Keep(7, 1, MakeOutcome());
  Study only_raw = study_;
  only_raw.scenario.controllers.pop_back();
  Open(only_raw).Keep(7, 0, MakeOutcome());
  EXPECT_EQ(Open().TrialCount(), 2);
}

TEST_F(StudyDatabaseTest, TrialsOfOtherSettingsOfAControllerStay) {
  study_.scenario.controllers[1].name = "it's mine";
  Open().Keep(7, 0, MakeOutcome());
  Open().Keep(7, 1, MakeOutcome());
  Study changed = study_;
  changed.scenario.controllers[1].config.filter_at = controller::FilterAt::kEvent;
  {
    StudyDatabase database = Open(changed);
    EXPECT_TRUE(database.Take(7, 0));
    EXPECT_FALSE(database.Take(7, 1));
    database.Keep(7, 1, MakeOutcome());
    EXPECT_EQ(database.TrialCount(), 2);
  }
  EXPECT_EQ(Open().TrialCount(), 2);
}

TEST_F(StudyDatabaseTest, AFileWithoutATrialIsTakenAwayAgain) {
  EXPECT_EQ(Open().TrialCount(), 0);
  EXPECT_TRUE(fs::is_empty(folder_.path()));
  Open().Keep(1, 0, MakeOutcome());
  EXPECT_TRUE(fs::exists(file_));
  Execute("DELETE FROM trial");
  Open();
  EXPECT_TRUE(fs::exists(file_));  // somebody else's doing
}

TEST_F(StudyDatabaseTest, AnEmptyFileIsANewDatabase) {
  std::ofstream(file_).close();
  Open().Keep(1, 0, MakeOutcome());
  EXPECT_TRUE(Open().Take(1, 0));
}

// Locks of other programs.

TEST_F(StudyDatabaseTest, TrialsWaitForALockToGo) {
  StudyDatabase database = Open();
  database.Keep(1, 0, MakeOutcome(1));
  SQLite::Database other(file_.string(), SQLite::OPEN_READWRITE);
  other.exec("BEGIN EXCLUSIVE");
  database.Keep(2, 0, MakeOutcome(2));
  database.Keep(3, 0, MakeOutcome(3));
  EXPECT_EQ(database.TrialCount(), 1);
  other.exec("ROLLBACK");
  database.Keep(4, 0, MakeOutcome(4));
  EXPECT_EQ(database.TrialCount(), 4);
  EXPECT_FALSE(database.Finish());
  for (const int seed : {1, 2, 3, 4}) {
    EXPECT_TRUE(SameBits(Open().Take(seed, 0).value(), MakeOutcome(seed))) << seed;
  }
}

TEST_F(StudyDatabaseTest, AReaderThatStaysIsToldInTheEnd) {
  StudyDatabase database = Open();
  database.Keep(1, 0, MakeOutcome());
  {
    SQLite::Database reader(file_.string());
    reader.exec("BEGIN");
    SQLite::Statement query(reader, "SELECT * FROM scores");
    query.executeStep();
    database.Keep(2, 0, MakeOutcome());
    const auto lacks = database.Finish();
    ASSERT_TRUE(lacks);
    EXPECT_EQ(*lacks, file_.string() +
                          ": lacks 1 trial of this comparison: another program (or its network "
                          "folder) keeps it locked; the same command adds them");
  }
  EXPECT_FALSE(database.Finish());
  EXPECT_EQ(Open().TrialCount(), 2);
}

TEST_F(StudyDatabaseTest, ALockThatStaysDeletesNothing) {
  std::optional<SQLite::Database> other;
  {
    StudyDatabase database = Open();
    database.Keep(1, 0, MakeOutcome());
    other.emplace(file_.string(), SQLite::OPEN_READWRITE);
    other->exec("BEGIN EXCLUSIVE");
    database.Keep(2, 0, MakeOutcome());
    EXPECT_TRUE(database.Finish());
  }
  EXPECT_THAT(OpeningSays<RunError>(), HasSubstr("keeps it locked; try again when it is free"));
  other.reset();
  EXPECT_EQ(Open().TrialCount(), 1);
}

TEST_F(StudyDatabaseTest, NobodyHasToWaitWhoWantsAnEnd) {
  Open().Keep(1, 0, MakeOutcome());
  SQLite::Database other(file_.string(), SQLite::OPEN_READWRITE);
  other.exec("BEGIN EXCLUSIVE");
  stop_signal = SIGINT;
  EXPECT_THROW(StudyDatabase(file_, study_, {.patience = std::chrono::hours(1)}), Cancelled);
  stop_signal = 0;
}

// Disks and network folders that fail.

TEST_F(StudyDatabaseTest, LosesNoTrialWhenNothingCanBeReadOrLocked) {
  for (int round = 0; round < 2; ++round) {
    std::optional<FailingCall> failing;  // still when the database goes
    {
      StudyDatabase database = Open();
      database.Keep(1, 0, MakeOutcome());
      database.Keep(2, 0, MakeOutcome());
      // A change by another program makes SQLite read the file again.
      Execute("UPDATE trial SET newest = 1");
      if (round == 0) {
        failing.emplace("fcntl", NoLocks);
      } else {
        failing.emplace(kRead, NothingToRead);
      }
      database.Keep(3, 0, MakeOutcome());
      const auto lacks = database.Finish();
      ASSERT_TRUE(lacks);
      EXPECT_THAT(*lacks, HasSubstr("lacks 1 trial of this comparison"));
    }
    failing.reset();
    EXPECT_EQ(Open().TrialCount(), 2);
    fs::remove(file_);
  }
}

TEST_F(StudyDatabaseTest, TriesAgainWhatTheDiskDidNotTake) {
  StudyDatabase database = Open();
  database.Keep(1, 0, MakeOutcome(1));
  {
    const FailingCall failing(kWrite, NothingTaken);
    database.Keep(2, 0, MakeOutcome(2));
    EXPECT_THAT(database.Finish().value(), HasSubstr("disk I/O error; the same command"));
  }
  database.Keep(3, 0, MakeOutcome(3));
  EXPECT_EQ(database.TrialCount(), 3);
  EXPECT_FALSE(database.Finish());
  for (const int seed : {1, 2, 3}) {
    EXPECT_TRUE(SameBits(Open().Take(seed, 0).value(), MakeOutcome(seed))) << seed;
  }
}

TEST_F(StudyDatabaseTest, AFullDiskEndsAComparisonAtOnce) {
  {
    StudyDatabase database = Open();
    database.Keep(1, 0, MakeOutcome());
    const FailingCall failing(kWrite, NoSpace);
    EXPECT_THROW(database.Keep(2, 0, MakeOutcome()), RunError);
    EXPECT_EQ(database.TrialCount(), 1);
  }
  EXPECT_EQ(Open().TrialCount(), 2);  // there was room again in the end
  fs::remove(file_);
  const FailingCall failing(kWrite, NoSpace);
  EXPECT_THAT(OpeningSays<RunError>(), HasSubstr("study.db: the disk is full"));
  EXPECT_TRUE(fs::is_empty(folder_.path()));
}

TEST_F(StudyDatabaseTest, AFileThatIsCutUnderItsFeetCostsNoResult) {
  {
    StudyDatabase database = Open();
    for (int seed = 1; seed < 4; ++seed) database.Keep(seed, 0, MakeOutcome());
    Execute("UPDATE trial SET newest = 1");
    fs::resize_file(file_, fs::file_size(file_) / 8192 * 4096);
    database.Keep(4, 0, MakeOutcome());
    EXPECT_THAT(database.Finish().value(), HasSubstr("lacks 1 trial of this comparison: "));
  }
  EXPECT_THAT(OpeningSays<UserError>(), HasSubstr("remove it, or name another folder by --out"));
}

// Damaged files.

TEST_F(StudyDatabaseTest, AFlippedBitGivesTheSameScoresOrOneClearLine) {
  constexpr int kTrials = 2;
  {
    StudyDatabase database = Open();
    for (int seed = 1; seed <= kTrials; ++seed) database.Keep(seed, 0, MakeOutcome(seed));
  }
  const std::string whole = ReadBytes(file_);
  std::mt19937 random(20261122);
  int refused = 0;
  int damaged = 0;
  for (int round = 0; round < 200; ++round) {
    std::string bytes = whole;
    // Every fourth in the first pages: header, definitions, trials. The others are mostly scores.
    const std::size_t offset = random() % (round % 4 == 0 ? 5 * 4096 : bytes.size());
    bytes[offset] = static_cast<char>(bytes[offset] ^ (1 << random() % 8));
    std::ofstream(file_, std::ios::binary) << bytes;
    SCOPED_TRACE("byte " + std::to_string(offset));
    try {
      bool kept = false;
      std::optional<std::string> lacks;
      {
        StudyDatabase database = Open();
        damaged += database.DamagedCount();
        for (int seed = 1; seed <= kTrials; ++seed) {
          const auto found = database.Take(seed, 0);
          EXPECT_TRUE(!found || SameBits(*found, MakeOutcome(seed)));
          if (found) continue;
          database.Keep(seed, 0, MakeOutcome(seed));
          kept = true;
        }
        lacks = database.Finish();
      }
      if (!kept || lacks) continue;
      StudyDatabase healed = Open();
      EXPECT_EQ(healed.DamagedCount(), 0);
      for (int seed = 1; seed <= kTrials; ++seed) {
        EXPECT_TRUE(SameBits(healed.Take(seed, 0).value(), MakeOutcome(seed)));
      }
    } catch (const UserError& error) {
      ++refused;
      EXPECT_THAT(error.what(), AllOf(HasSubstr("; remove it"), Not(HasSubstr("\n"))));
    } catch (const RunError& error) {
      ++refused;
      EXPECT_THAT(error.what(), AllOf(HasSubstr("study.db: "), Not(HasSubstr("\n"))));
    }
  }
  EXPECT_GT(damaged, 2 * refused);  // most of the file is scores
}

TEST_F(StudyDatabaseTest, WhatAnybodyChangesInATrialIsFoundAndComputedAgain) {
  for (const char* change :
       {"UPDATE score SET value = 'much' WHERE metric = 'delay_ms'",
        "UPDATE score SET value = value + 1e-12 WHERE metric = 'delay_ms'",
        "UPDATE score SET value = 9e999 WHERE metric = 'delay_ms'",
        "UPDATE score SET metric = 'delay' WHERE metric = 'delay_ms'",
        "UPDATE score SET channel = 'nose' WHERE channel = 'summary'",
        "DELETE FROM score WHERE channel = 'summary' AND metric = 'delay_ms'",
        "INSERT INTO score VALUES (1, 'nose', 'delay_ms', 1)",
        "UPDATE untrusted SET samples = samples + 1 WHERE samples > 0",
        "UPDATE untrusted SET samples = 'few'", "UPDATE trial SET problem = 'none'",
        "UPDATE trial SET seed = 8", "UPDATE trial SET controller = 'same'",
        "UPDATE trial SET checksum = 0"}) {
    SCOPED_TRACE(change);
    Open().Keep(7, 0, MakeOutcome());
    Execute(change);
    {
      StudyDatabase database = Open();
      EXPECT_EQ(database.TrialCount(), 0);
      EXPECT_FALSE(database.Take(7, 0));
      database.Keep(7, 0, MakeOutcome());
      EXPECT_FALSE(database.Finish());
    }
    EXPECT_TRUE(SameBits(Open().Take(7, 0).value(), MakeOutcome()));
    fs::remove(file_);
  }
}

TEST_F(StudyDatabaseTest, TablesThatAreNotItsOwnAreOneClearLine) {
  const std::string advice = "; remove it, or name another folder by --out";
  const std::string file = file_.string();
  for (const auto& [change, said] : std::map<std::string, std::string>{
           {"DROP TABLE untrusted", ": has no table or view untrusted"},
           {"DROP VIEW scores", ": has no table or view scores"},
           {"ALTER TABLE trial DROP COLUMN problem",
            ": its table or view trial is not as Gauntlet makes it"},
           {"ALTER TABLE score RENAME COLUMN value TO worth",
            ": its table or view all_scores is not as Gauntlet makes it"},
           {"PRAGMA user_version = 3", ": is not a study database of this version of Gauntlet"},
           {"PRAGMA writable_schema = 1; UPDATE sqlite_schema SET sql = sql || char(10, 34) WHERE "
            "name = "
            "'score'",
            ": is damaged"}}) {
    Open().Keep(7, 0, MakeOutcome());
    Execute(change);
    EXPECT_EQ(OpeningSays<UserError>(), file + said + advice);
    EXPECT_TRUE(fs::exists(file_));
    fs::remove(file_);
  }
}

TEST_F(StudyDatabaseTest, TablesBesideItsOwnStay) {
  Open().Keep(7, 0, MakeOutcome());
  Execute("CREATE TABLE mine (note TEXT); CREATE INDEX by_metric ON score (metric)");
  EXPECT_TRUE(Open().Take(7, 0));
}

// Places where no database can be, found before the first trial.

TEST_F(StudyDatabaseTest, WhatIsNoFileOfItsOwnIsTheUsersMistake) {
  fs::create_directory(file_);
  EXPECT_THAT(OpeningSays<UserError>(), HasSubstr("study.db: is not a file of its own"));
}

// A folder of somebody else may contain any link.
TEST_F(StudyDatabaseTest, RefusesALinkAndLeavesWhatItNames) {
  const fs::path outside = folder_.path() / "outside";
  const std::string journal = file_.string() + "-journal";
  for (const std::string& link : {file_.string(), journal}) {
    fs::create_symlink(outside, link);
    const std::string problem =
        link + ": is a symbolic link; remove it, or name another folder by --out";
    EXPECT_EQ(OpeningSays<UserError>(), problem);
    EXPECT_FALSE(fs::exists(outside));
    std::ofstream(outside) << "mine";
    EXPECT_EQ(OpeningSays<UserError>(), problem);
    EXPECT_EQ(ReadBytes(outside), "mine");
    EXPECT_TRUE(fs::is_symlink(link));
    fs::remove(link);
    fs::remove(outside);
  }
  EXPECT_TRUE(fs::is_empty(folder_.path()));
}

// A journal of several databases names a file that SQLite removes when it has undone the
// transaction: the folder of another person could name any.
TEST_F(StudyDatabaseTest, RefusesAJournalThatNamesAFileOfTheUser) {
  Open().Keep(1, 0, MakeOutcome());
  const std::string mine = folder_.path() / "mine";
  std::ofstream(mine) << "mine";
  const auto number = [](std::size_t value) {
    std::string bytes;
    for (const int shift : {24, 16, 8, 0}) bytes += static_cast<char>(value >> shift & 0xFF);
    return bytes;
  };
  const std::string mark = "\xd9\xd5\x05\xf9\x20\xa1\x63\xd7";
  std::string head = mark + number(0) + number(1) + number(fs::file_size(file_) / 4096) +
                     number(512) + number(4096);
  head.resize(512);
  std::size_t sum = 0;
  for (const char letter : mine) sum += letter;
  const fs::path journal = file_.string() + "-journal";
  std::ofstream(journal) << head << number((1 << 30) / 4096 + 1) << mine << number(mine.size())
                         << number(sum) << mark;
  EXPECT_THAT(OpeningSays<UserError>(),
              HasSubstr("study.db-journal: names a file that SQLite would remove; remove it"));
  EXPECT_EQ(ReadBytes(mine), "mine");
  EXPECT_TRUE(fs::exists(journal));
  SQLite::Database(file_.string(), SQLite::OPEN_READWRITE).execAndGet("SELECT count(*) FROM trial");
  EXPECT_FALSE(fs::exists(mine));  // so the journal was one that does it
}

TEST_F(StudyDatabaseTest, TheFolderMayBeALink) {
  fs::create_directory(folder_.path() / "real");
  fs::create_directory_symlink("real", folder_.path() / "link");
  file_ = folder_.path() / "link/study.db";
  Open().Keep(1, 0, MakeOutcome());
  EXPECT_TRUE(Open().Take(1, 0));
  EXPECT_TRUE(fs::exists(folder_.path() / "real/study.db"));
}

TEST_F(StudyDatabaseTest, APathCanBeAsLongAsSqliteTakesIt) {
  const std::size_t longest =
      sqlite3_vfs_find(nullptr)->mxPathname - std::string("-journal").size();
  const auto with_length = [&](std::size_t length) {
    fs::path folder = folder_.path();
    while (folder.native().size() + 102 + file_.filename().native().size() < length) {
      folder /= std::string(100, 'x');
    }
    folder /=
        std::string(length - folder.native().size() - 2 - file_.filename().native().size(), 'y');
    fs::create_directories(folder);
    return folder / file_.filename();
  };
  file_ = with_length(longest);
  Open().Keep(1, 0, MakeOutcome());
  EXPECT_TRUE(Open().Take(1, 0));
  file_ = with_length(longest + 1);
  EXPECT_THAT(OpeningSays<UserError>(), HasSubstr("--out: the path of study.db has"));
  EXPECT_FALSE(fs::exists(file_));
}

TEST_F(StudyDatabaseTest, AFileThatCannotBeWrittenIsFoundWhenItIsOpened) {
  Open().Keep(1, 0, MakeOutcome());
  std::string bytes = ReadBytes(file_);
  bytes[18] = 3;  // a way of writing that is not invented yet: to be read only
  std::ofstream(file_, std::ios::binary) << bytes;
  EXPECT_THAT(OpeningSays<RunError>(), HasSubstr("attempt to write a readonly database"));
  EXPECT_TRUE(fs::exists(file_));
}

TEST_F(StudyDatabaseTest, APathIsNoAddress) {
  const fs::path before = fs::current_path();
  fs::current_path(folder_.path());
  fs::create_directory("file:u?mode=ro");
  file_ = "file:u?mode=ro/study.db";
  Open().Keep(1, 0, MakeOutcome());
  EXPECT_TRUE(Open().Take(1, 0));
  fs::current_path(before);
  EXPECT_TRUE(fs::exists(folder_.path() / file_));
}

}  // namespace
}  // namespace gauntlet::sim
