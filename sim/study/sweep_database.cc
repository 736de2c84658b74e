#include "sim/study/sweep_database.h"

#include <SQLiteCpp/SQLiteCpp.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <chrono>
#include <cmath>
#include <limits>
#include <mutex>
#include <span>
#include <sstream>

#include "sim/base/error.h"
#include "sim/base/hash.h"
#include "sim/base/stop.h"
#include "sim/study/study_schema.h"

namespace gauntlet::sim {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

constexpr int kPatienceMs = 10'000;  // for other programs
constexpr std::chrono::milliseconds kBetweenWrites{250};

TrialColumns ColumnsOf(const SweepTrialKey& key) {
  return {
      .study = key.study, .controller = key.controller, .settings = key.settings, .seed = key.seed};
}

std::string ChecksumOf(const SweepTrialKey& key, const TrialOutcome& outcome,
                       const std::vector<std::size_t>& metrics) {
  Hash hash;
  hash.Add(fmt::format("{}\n{}\n{}\n{}\n{}\n", key.study, key.controller, key.settings, key.seed,
                       outcome.health.problem));
  for (const std::size_t metric : metrics) {
    const double value = outcome.scores.summary[metric];
    const double kept = std::isfinite(value) ? value : std::numeric_limits<double>::quiet_NaN();
    hash.Add(std::span<const double>(&kept, 1));
  }
  return hash.Text();
}

}  // namespace

namespace {

/// A statement that is asked for every trial or cell: made once, and at rest again at the end of
/// the scope, or it would hold the file.
class Prepared {
 public:
  Prepared(std::optional<SQLite::Statement>& statement, const SQLite::Database& database,
           const char* sql)
      : statement_(statement ? *statement : statement.emplace(database, sql)) {}
  ~Prepared() { statement_.tryReset(); }
  Prepared(const Prepared&) = delete;
  Prepared& operator=(const Prepared&) = delete;

  SQLite::Statement& operator*() { return statement_; }
  SQLite::Statement* operator->() { return &statement_; }

 private:
  SQLite::Statement& statement_;
};

}  // namespace

struct SweepDatabase::State {
  struct KeptTrial {
    SweepTrialKey key;
    TrialOutcome outcome;
  };
  struct KeptCell {
    SweepCellRecord cell;
    std::vector<std::pair<std::string, std::string>> values;
  };

  void Open();
  void WriteAll();
  void WriteTrial(const KeptTrial& kept);
  void WriteCell(const KeptCell& kept);

  const fs::path file;
  const std::string sweep;
  const std::vector<std::size_t> metrics;
  std::mutex mutex;
  std::optional<SQLite::Database> database;
  std::optional<SQLite::Statement> take, cell_at, add_trial, add_score;  // of `database`
  std::vector<KeptTrial> trials;                                         // not yet written
  std::vector<KeptCell> cells;
  std::vector<std::pair<std::string, std::string>> studies;
  Clock::time_point written = Clock::now();
  int damaged = 0;
};

void SweepDatabase::State::Open() {
  CheckDatabasePlace(file);
  database.emplace(fs::absolute(file).string(), SQLite::OPEN_READWRITE | SQLite::OPEN_CREATE);
  database->setBusyTimeout(kPatienceMs);
  database->exec("PRAGMA synchronous = NORMAL");
  if (!HasTables(*database)) {
    MakeTables(*database);
  } else {
    CheckTables(file, *database);
  }
}

void SweepDatabase::State::WriteTrial(const KeptTrial& kept) {
  const TrialColumns columns = ColumnsOf(kept.key);
  RemoveTrial(columns, *database);  // a damaged one
  Prepared add(add_trial, *database,
               "INSERT INTO trial (study, controller, settings, seed, problem, newest, "
               "checksum) VALUES (?, ?, ?, ?, ?, 1, ?)");
  Bind(columns, *add);
  add->bind(5, kept.outcome.health.problem);
  add->bind(6, ChecksumOf(kept.key, kept.outcome, metrics));
  add->exec();
  const std::int64_t trial = database->getLastInsertRowid();
  Prepared score(add_score, *database, "INSERT INTO score VALUES (?, 'summary', ?, ?)");
  for (const std::size_t metric : metrics) {
    const double value = kept.outcome.scores.summary[metric];
    if (!std::isfinite(value)) continue;  // what is not there is no score
    score->bind(1, trial);
    score->bind(2, std::string(Metrics()[metric].key));
    score->bind(3, value);
    score->exec();
    score->reset();
  }
}

void SweepDatabase::State::WriteCell(const KeptCell& kept) {
  const auto& [cell, values] = kept;
  SQLite::Statement add(*database, "INSERT OR REPLACE INTO cell VALUES (?, ?, ?, ?, ?, ?, ?)");
  add.bind(1, sweep);
  add.bind(2, cell.number);
  add.bind(3, cell.controller);
  add.bind(4, cell.study);
  add.bind(5, cell.settings);
  add.bind(6, fmt::format("{}", fmt::join(cell.motions, " ")));
  add.bind(7, cell.problem);
  add.exec();
  SQLite::Statement value(*database, "INSERT OR REPLACE INTO cell_value VALUES (?, ?, ?, ?)");
  for (const auto& [key, text] : values) {
    value.bind(1, sweep);
    value.bind(2, cell.number);
    value.bind(3, key);
    value.bind(4, text);
    value.exec();
    value.reset();
  }
}

/// One transaction. Errors: SQLite::Exception; then all still waits.
void SweepDatabase::State::WriteAll() {
  written = Clock::now();
  if (trials.empty() && cells.empty() && studies.empty()) return;
  const Unbroken unbroken;  // or its journal would be left
  SQLite::Transaction transaction(*database, SQLite::TransactionBehavior::EXCLUSIVE);
  SQLite::Statement study(*database, "INSERT OR IGNORE INTO study VALUES (?, ?)");
  for (const auto& [hash, scenario] : studies) {
    study.bind(1, hash);
    study.bind(2, scenario);
    study.exec();
    study.reset();
  }
  for (const KeptTrial& kept : trials) WriteTrial(kept);
  for (const KeptCell& kept : cells) WriteCell(kept);
  transaction.commit();
  trials.clear();
  cells.clear();
  studies.clear();
}

SweepDatabase::SweepDatabase(fs::path file, std::string sweep, std::vector<std::size_t> metrics)
    : state_(new State{.file = std::move(file),
                       .sweep = std::move(sweep),
                       .metrics = std::move(metrics),
                       .mutex = {},
                       .database = {},
                       .take = {},
                       .cell_at = {},
                       .add_trial = {},
                       .add_score = {},
                       .trials = {},
                       .cells = {},
                       .studies = {}}) {
  try {
    state_->Open();
  } catch (const SQLite::Exception& error) {
    ThrowCannotOpen(state_->file, error);
  }
}

SweepDatabase::~SweepDatabase() {
  try {
    state_->WriteAll();
  } catch (const std::exception&) {  // NOLINT(bugprone-empty-catch): Flush() would have told
  }
}

std::optional<TrialOutcome> SweepDatabase::Take(const SweepTrialKey& key) {
  return TakeSeeds(key, 1).front();
}

std::vector<std::optional<TrialOutcome>> SweepDatabase::TakeSeeds(const SweepTrialKey& first,
                                                                  int seeds) {
  State& state = *state_;
  const std::lock_guard lock(state.mutex);
  std::vector<std::optional<TrialOutcome>> outcomes(static_cast<std::size_t>(seeds));
  std::vector<std::string> checksums(outcomes.size());
  try {
    Prepared query(state.take, *state.database,
                   "SELECT problem, checksum, metric, value, seed FROM trial "
                   "LEFT JOIN score ON score.trial = trial.id AND channel = 'summary' WHERE "
                   "study = ? AND controller = ? AND settings = ? AND seed >= ? AND seed < ?");
    Bind(ColumnsOf(first), *query);
    query->bind(5, std::int64_t{first.seed} + seeds);
    while (query->executeStep()) {
      const auto place = static_cast<std::size_t>(query->getColumn(4).getInt64() - first.seed);
      std::optional<TrialOutcome>& outcome = outcomes[place];
      if (!outcome) {
        outcome.emplace();
        outcome->scores.summary.assign(Metrics().size(), std::numeric_limits<double>::quiet_NaN());
        outcome->health.problem = query->getColumn(0).getString();
        outcome->health.ok = outcome->health.problem.empty();
        checksums[place] = query->getColumn(1).getString();
      }
      if (query->isColumnNull(2)) continue;
      const std::optional<std::size_t> metric = FindMetric(TextOf(query->getColumn(2)));
      if (metric) outcome->scores.summary[*metric] = query->getColumn(3).getDouble();
    }
  } catch (const SQLite::Exception& error) {
    ThrowCannotOpen(state.file, error);
  }
  SweepTrialKey key = first;
  for (std::size_t i = 0; i < outcomes.size(); ++i, ++key.seed) {
    if (!outcomes[i] || ChecksumOf(key, *outcomes[i], state.metrics) == checksums[i]) continue;
    ++state.damaged;
    outcomes[i].reset();
  }
  return outcomes;
}

void SweepDatabase::ReadTogether(const std::function<void()>& work) {
  try {
    SQLite::Transaction transaction(*state_->database, SQLite::TransactionBehavior::DEFERRED);
    work();
    transaction.commit();
  } catch (const SQLite::Exception& error) {
    ThrowCannotOpen(state_->file, error);
  }
}

void SweepDatabase::Keep(const SweepTrialKey& key, const TrialOutcome& outcome) {
  State& state = *state_;
  const std::lock_guard lock(state.mutex);
  State::KeptTrial& kept = state.trials.emplace_back(State::KeptTrial{key, {}});
  kept.outcome.health = outcome.health;
  kept.outcome.scores.summary = outcome.scores.summary;
  if (Clock::now() - state.written < kBetweenWrites) return;
  state.database->setBusyTimeout(0);  // another program may take its time: there is a next time
  try {
    state.WriteAll();
  } catch (const SQLite::Exception& error) {
    if (TroubleOf(error) == Trouble::kFullDisk) {
      throw RunError(state.file.string() +
                     ": the disk is full; the same command goes on from the trials that are kept");
    }
  }
  state.database->setBusyTimeout(kPatienceMs);
}

void SweepDatabase::AddStudy(const std::string& study, const std::string& scenario) {
  const std::lock_guard lock(state_->mutex);
  state_->studies.emplace_back(study, scenario);
}

void SweepDatabase::AddCell(const SweepCellRecord& cell,
                            const std::vector<std::pair<std::string, std::string>>& values) {
  const std::lock_guard lock(state_->mutex);
  state_->cells.push_back({cell, values});
}

std::vector<SweepCellRecord> SweepDatabase::CellAt(std::int64_t number) {
  State& state = *state_;
  const std::lock_guard lock(state.mutex);
  std::vector<SweepCellRecord> records;
  try {
    Prepared query(state.cell_at, *state.database,
                   "SELECT controller, study, settings, motions, problem FROM cell "
                   "WHERE sweep = ? AND number = ? ORDER BY controller");
    query->bind(1, state.sweep);
    query->bind(2, number);
    while (query->executeStep()) {
      SweepCellRecord& record =
          records.emplace_back(SweepCellRecord{.number = number,
                                               .controller = query->getColumn(0).getString(),
                                               .study = query->getColumn(1).getString(),
                                               .settings = query->getColumn(2).getString(),
                                               .motions = {},
                                               .problem = query->getColumn(4).getString()});
      std::istringstream motions(query->getColumn(3).getString());
      for (int motion = 0; motions >> motion;) record.motions.push_back(motion);
    }
  } catch (const SQLite::Exception& error) {
    ThrowCannotOpen(state.file, error);
  }
  return records;
}

void SweepDatabase::Flush() {
  State& state = *state_;
  const std::lock_guard lock(state.mutex);
  try {
    state.WriteAll();
  } catch (const SQLite::Exception& error) {
    const std::string why =
        TroubleOf(error) == Trouble::kLock
            ? "another program (or its network folder) keeps it locked"
            : (TroubleOf(error) == Trouble::kFullDisk ? "the disk is full" : error.what());
    throw RunError(fmt::format("{}: lacks {} trial{} of this sweep: {}; the same command adds them",
                               state.file.string(), state.trials.size(),
                               state.trials.size() == 1 ? "" : "s", why));
  }
}

void SweepDatabase::Collect(const fs::path& other) {
  State& state = *state_;
  const std::lock_guard lock(state.mutex);
  if (!fs::is_regular_file(other)) {
    throw UserError(
        {.place = "--collect", .key = other.string(), .problem = "there is no such file"});
  }
  try {
    {
      SQLite::Database there(fs::absolute(other).string(), SQLite::OPEN_READONLY);
      CheckTables(other, there);
    }
    SQLite::Statement attach(*state.database, "ATTACH ? AS other");
    attach.bind(1, fs::absolute(other).string());
    attach.exec();
    const Unbroken unbroken;
    SQLite::Transaction transaction(*state.database, SQLite::TransactionBehavior::EXCLUSIVE);
    constexpr const char* kSame =
        "JOIN other.trial AS theirs ON theirs.id = rows.trial JOIN main.trial AS ours "
        "USING (study, controller, settings, seed)";
    state.database->exec("INSERT OR IGNORE INTO main.study SELECT * FROM other.study");
    state.database->exec(
        "INSERT OR IGNORE INTO main.trial (seed, controller, study, settings, problem, newest, "
        "checksum) SELECT seed, controller, study, settings, problem, newest, checksum "
        "FROM other.trial");
    state.database->exec(fmt::format(
        "INSERT OR IGNORE INTO main.score SELECT ours.id, rows.channel, rows.metric, rows.value "
        "FROM other.score AS rows {}",
        kSame));
    state.database->exec(fmt::format(
        "INSERT OR IGNORE INTO main.untrusted SELECT ours.id, rows.channel, rows.samples "
        "FROM other.untrusted AS rows {}",
        kSame));
    state.database->exec("INSERT OR IGNORE INTO main.cell SELECT * FROM other.cell");
    state.database->exec("INSERT OR IGNORE INTO main.cell_value SELECT * FROM other.cell_value");
    transaction.commit();
    state.database->exec("DETACH other");
  } catch (const SQLite::Exception& error) {
    ThrowCannotOpen(other, error);
  }
}

std::int64_t SweepDatabase::TrialCount() {
  const std::lock_guard lock(state_->mutex);
  return state_->database->execAndGet("SELECT count(*) FROM trial").getInt64();
}

int SweepDatabase::DamagedCount() const { return state_->damaged; }

}  // namespace gauntlet::sim
