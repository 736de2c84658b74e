#include "sim/study/trial_table/trial_table.h"

#include <fmt/format.h>
#include <sqlite3.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <thread>
#include <utility>

#include "sim/base/error.h"
#include "sim/base/stop.h"
#include "sim/study/trial_table/study_schema.h"

namespace gauntlet::sim {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

/// Time between two tries of a lock.
constexpr std::chrono::milliseconds kLockPause{20};

/// The text of a column, as long as its row is.
std::string_view TextOf(const SQLite::Column& column) {
  return {column.getText(), static_cast<std::size_t>(column.getBytes())};
}

}  // namespace

std::string KeptIn(const std::filesystem::path& file) {
  return "kept in " + file.string() + ": the same command continues from there";
}

TrialTable::TrialTable(fs::path file, TrialTableOptions options)
    : file_(std::move(file)), options_(std::move(options)) {
  std::error_code ignored;
  made_ = fs::symlink_status(file_, ignored).type() == fs::file_type::not_found;
  try {
    Open();
  } catch (const SQLite::Exception& error) {
    Close();
    ThrowIfStopped();
    ThrowCannotOpen(file_, error);
  }
}

TrialTable::~TrialTable() {
  try {
    TryToWrite(false);
  } catch (const std::exception&) {  // NOLINT(bugprone-empty-catch): Finish() reports it
  }
  Close();
}

void TrialTable::Close() {
  statements_.clear();
  database_.reset();
  std::error_code ignored;
  if (made_ && !used_) fs::remove(file_, ignored);
}

void TrialTable::Open() {
  CheckDatabasePlace(file_);
  database_.emplace(InRealFolder(file_).string(),
                    SQLite::OPEN_READWRITE | SQLite::OPEN_CREATE | SQLite::OPEN_NOFOLLOW);
  sqlite3_busy_handler(
      database_->getHandle(),
      [](void* self, int tries) {
        TrialTable& table = *static_cast<TrialTable*>(self);
        if (tries == 0) table.wait_end_ = Clock::now() + table.options_.patience;
        if (!table.waits_ || StopAsked() || Clock::now() >= table.wait_end_) return 0;
        std::this_thread::sleep_for(kLockPause);
        return 1;
      },
      this);
  database_->exec("PRAGMA synchronous = NORMAL");
  database_->exec("PRAGMA foreign_keys = OFF");  // rows of damaged trials may break them
  if (!HasTables(*database_)) {
    MakeTables(*database_);
  } else {
    CheckTables(file_, *database_);
  }
}

TrialTable::Prepared TrialTable::Find(std::string_view sql) {
  auto known = statements_.find(sql);
  if (known == statements_.end()) {
    known = statements_.try_emplace(sql, *database_, std::string(sql)).first;
  }
  return Prepared(&known->second);
}

std::vector<std::optional<TrialOutcome>> TrialTable::Read(const TrialKey& first, int seeds) {
  std::vector<std::optional<TrialOutcome>> outcomes(static_cast<std::size_t>(seeds));
  try {
    const Prepared trials = Prepare(
        "SELECT id, seed, problem, checksum FROM trial WHERE study = ? AND controller = ? "
        "AND settings = ? AND seed >= ? AND seed < ? AND typeof(seed) = 'integer'",
        first.study, first.controller, first.settings, first.seed, first.seed + seeds);
    TrialKey key = first;
    while (trials->executeStep()) {
      ThrowIfStopped();
      const std::int64_t row = trials->getColumn(0).getInt64();
      key.seed = trials->getColumn(1).getInt64();
      const std::int64_t place = key.seed - first.seed;
      TrialOutcome outcome;
      outcome.health.problem = trials->getColumn(2).getString();
      outcome.health.ok = outcome.health.problem.empty();
      const bool whole =
          place >= 0 && place < seeds &&  // a damaged index gives others
          ReadParts(row, outcome) &&
          options_.checksum(key, outcome, options_.metrics) == TextOf(trials->getColumn(3));
      if (whole) {
        outcomes[static_cast<std::size_t>(place)] = std::move(outcome);
      } else if (damaged_rows_.insert(row).second) {
        ++damaged_;
      }
    }
  } catch (const SQLite::Exception& error) {
    ThrowIfStopped();
    ThrowCannotOpen(file_, error);
  }
  return outcomes;
}

/// Scores and counts of a trial. False if it has rows that no trial has.
bool TrialTable::ReadParts(std::int64_t row, TrialOutcome& outcome) {
  const auto place_of = [](const std::vector<std::string>& names, std::string_view name) {
    return static_cast<std::size_t>(std::ranges::find(names, name) - names.begin());
  };
  Scores& scores = outcome.scores;
  scores.summary.assign(Metrics().size(), std::numeric_limits<double>::quiet_NaN());
  scores.channels.assign(options_.rows.size(), scores.summary);
  const Prepared query = Prepare("SELECT channel, metric, value FROM score WHERE trial = ?", row);
  while (query->executeStep()) {
    const std::string_view channel = TextOf(query->getColumn(0));
    const std::optional<std::size_t> metric = FindMetric(TextOf(query->getColumn(1)));
    const SQLite::Column value = query->getColumn(2);
    if (!metric || !value.isFloat() || !std::isfinite(value.getDouble())) return false;
    const bool summary = channel == kSummaryChannel;
    const std::size_t place = summary ? 0 : place_of(options_.rows, channel);
    if (!summary && place == options_.rows.size()) return false;
    (summary ? scores.summary : scores.channels[place])[*metric] = value.getDouble();
  }
  outcome.untrusted_samples.assign(options_.channels.size(), 0);
  if (options_.channels.empty()) return true;
  const Prepared counts = Prepare("SELECT channel, samples FROM untrusted WHERE trial = ?", row);
  while (counts->executeStep()) {
    const std::size_t place = place_of(options_.channels, TextOf(counts->getColumn(0)));
    const SQLite::Column samples = counts->getColumn(1);
    if (place == options_.channels.size() || !samples.isInteger()) return false;
    outcome.untrusted_samples[place] = samples.getInt64();
  }
  return true;
}

void TrialTable::ReadTogether(const std::function<void()>& work) {
  try {
    SQLite::Transaction transaction(*database_, SQLite::TransactionBehavior::DEFERRED);
    work();
    transaction.commit();
  } catch (const SQLite::Exception& error) {
    ThrowIfStopped();
    ThrowCannotOpen(file_, error);
  }
}

/// Nothing if all is written. Waits for other programs, or not.
std::optional<SQLite::Exception> TrialTable::TryToWrite(bool waits) {
  struct Again {  // on every way out
    bool& flag;
    ~Again() { flag = true; }
  } again{waits_ = waits};
  try {
    WriteAll();
  } catch (const SQLite::Exception& error) {
    return error;
  }
  return std::nullopt;
}

/// One transaction. Errors: SQLite::Exception; then all of it still waits.
void TrialTable::WriteAll() {
  written_ = Clock::now();
  if (changes_.empty() && trials_.empty()) return;
  const Unbroken unbroken;  // or its journal would be left
  // Exclusive from the start: if another program reads, nothing is done in vain.
  SQLite::Transaction transaction(*database_, SQLite::TransactionBehavior::EXCLUSIVE);
  if (!damaged_rows_.empty()) RemoveDamaged();
  for (const Change& change : changes_) change(*this);
  int added = 0;
  for (const auto& [key, outcome] : trials_) {
    if (!Remove(key)) ++added;
    Insert(key, outcome);
  }
  transaction.commit();
  added_ += added;
  used_ = used_ || added > 0;
  damaged_rows_.clear();
  changes_.clear();
  trials_.clear();
}

/// With what is left of them. Where a key is damaged, rows are out of order, and SQLite does not
/// find the rows behind them: so all rows are written again.
void TrialTable::RemoveDamaged() {
  for (const std::int64_t row : damaged_rows_) Run("DELETE FROM trial WHERE id = ?", row);
  for (const char* table : {"score", "untrusted"}) {
    database_->exec(
        fmt::format("CREATE TABLE temp.whole AS SELECT * FROM main.{0} "
                    "WHERE +trial IN (SELECT id FROM main.trial);"  // +: one by one, not by key
                    "DELETE FROM main.{0};"
                    "INSERT OR IGNORE INTO main.{0} SELECT * FROM temp.whole;"
                    "DROP TABLE temp.whole",
                    table));
  }
}

/// True if there was one.
bool TrialTable::Remove(const TrialKey& key) {
  const Prepared find = Prepare(
      "SELECT id FROM trial WHERE study = ? AND controller = ? AND settings = ? AND seed = ?",
      key.study, key.controller, key.settings, key.seed);
  if (!find->executeStep()) return false;
  const std::int64_t row = find->getColumn(0).getInt64();
  find->reset();
  for (const std::string_view sql :
       {"DELETE FROM score WHERE trial = ?", "DELETE FROM untrusted WHERE trial = ?",
        "DELETE FROM trial WHERE id = ?"}) {
    Run(sql, row);
  }
  return true;
}

void TrialTable::Insert(const TrialKey& key, const TrialOutcome& outcome) {
  Run("INSERT INTO trial (study, controller, settings, seed, problem, newest, checksum) "
      "VALUES (?, ?, ?, ?, ?, 1, ?)",
      key.study, key.controller, key.settings, key.seed, outcome.health.problem,
      options_.checksum(key, outcome, options_.metrics));
  const std::int64_t row = database_->getLastInsertRowid();
  const auto add_scores = [&](const std::string& channel, const std::vector<double>& values) {
    for (const std::size_t metric : options_.metrics) {
      if (!std::isfinite(values[metric])) continue;  // a missing score has no row
      Run("INSERT INTO score VALUES (?, ?, ?, ?)", row, channel, std::string(Metrics()[metric].key),
          values[metric]);
    }
  };
  add_scores(std::string(kSummaryChannel), outcome.scores.summary);
  for (std::size_t i = 0; i < options_.rows.size(); ++i) {
    add_scores(options_.rows[i], outcome.scores.channels[i]);
  }
  for (std::size_t c = 0; c < options_.channels.size(); ++c) {
    Run("INSERT INTO untrusted VALUES (?, ?, ?)", row, options_.channels[c],
        outcome.untrusted_samples[c]);
  }
}

void TrialTable::Keep(TrialKey key, TrialOutcome outcome) {
  trials_.emplace_back(std::move(key), std::move(outcome));
  if (Clock::now() - written_ < options_.between_writes) return;
  const auto problem = TryToWrite(false);
  if (problem && TroubleOf(*problem) == Trouble::kFullDisk) {
    throw RunError(file_.string() +
                   ": the disk is full; the same command continues from the trials that are kept");
  }
}

void TrialTable::WriteUnlessLocked() {
  const auto problem = TryToWrite(false);
  if (problem && TroubleOf(*problem) != Trouble::kLock) ThrowCannotOpen(file_, *problem);
}

std::optional<std::string> TrialTable::Finish() {
  const auto problem = TryToWrite(true);
  if (!problem) return std::nullopt;
  const Trouble trouble = TroubleOf(*problem);
  const std::string lacks = trials_.empty()       ? "rows"
                            : trials_.size() == 1 ? "1 trial"
                                                  : fmt::format("{} trials", trials_.size());
  const std::string_view why = trouble == Trouble::kLock       ? kLockedByAnother
                               : trouble == Trouble::kFullDisk ? "the disk is full"
                                                               : problem->what();
  return fmt::format("{}: lacks {} of this {}: {}; the same command adds them", file_.string(),
                     lacks, options_.kept_for, why);
}

}  // namespace gauntlet::sim
