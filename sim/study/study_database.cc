#include "sim/study/study_database.h"

#include <SQLiteCpp/SQLiteCpp.h>
#include <fmt/format.h>
#include <sqlite3.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <deque>
#include <iterator>
#include <limits>
#include <map>
#include <mutex>
#include <set>
#include <span>
#include <string_view>
#include <thread>
#include <vector>

#include "sim/base/error.h"
#include "sim/base/hash.h"
#include "sim/base/stop.h"
#include "sim/study/study_schema.h"

namespace gauntlet::sim {
namespace {

namespace fs = std::filesystem;

/// How often a lock of another program is tried.
constexpr std::chrono::milliseconds kLockPause{20};

using Clock = std::chrono::steady_clock;

/// A trial of this study.
struct Key {
  std::size_t controller = 0;
  std::int64_t seed = 0;
  auto operator<=>(const Key&) const = default;
};

struct FoundTrial {
  std::int64_t row = 0;
  TrialOutcome outcome;
};

struct KeptTrial {
  Key key;
  TrialOutcome outcome;
};

std::string ChecksumOf(const TrialColumns& columns, const TrialOutcome& outcome) {
  Hash hash;
  const auto add_number = [&hash](auto number) {
    hash.Add(std::span<const decltype(number)>(&number, 1));
  };
  const auto add_text = [&](std::string_view text) {
    add_number(text.size());  // so that no text runs into the next
    hash.Add(text);
  };
  const auto add_values = [&](const std::vector<double>& values) {
    for (const double value : values) {
      // What is not finite is not kept, and read as missing.
      add_number(std::isfinite(value) ? value : std::numeric_limits<double>::quiet_NaN());
    }
  };
  add_text(columns.study);
  add_text(columns.controller);
  add_text(columns.settings);
  add_number(columns.seed);
  add_text(outcome.health.problem);
  add_values(outcome.scores.summary);
  for (const std::vector<double>& channel : outcome.scores.channels) add_values(channel);
  for (const std::int64_t samples : outcome.untrusted_samples) add_number(samples);
  return hash.Text();
}

}  // namespace

struct StudyDatabase::State {
  State(fs::path path, const Study& s, StudyIdentity i, StudyDatabaseOptions o)
      : file(std::move(path)), study(s), identity(std::move(i)), options(std::move(o)) {}
  ~State();

  void Open();
  void ReadTrials();
  std::optional<TrialOutcome> ReadTrial(std::int64_t trial, std::string problem) const;
  bool ReadScores(std::int64_t trial, Scores& scores) const;
  bool ReadUntrusted(std::int64_t trial, std::vector<std::int64_t>& samples) const;

  void Start();
  void RemoveDamagedTrials();
  void Write(const KeptTrial* kept);
  void AddScores(std::int64_t trial, const TrialOutcome& outcome);
  void WriteWaiting();
  void WriteAll();

  TrialColumns ColumnsOf(const Key& key) const {
    return {.study = identity.hash,
            .controller = Controller(key.controller),
            .settings = identity.controller_settings[key.controller],
            .seed = key.seed};
  }
  const std::string& Controller(std::size_t index) const {
    return study.scenario.controllers[index].name;
  }
  const std::vector<std::string>& Channels() const { return study.channel_names(); }
  const std::vector<std::string>& Rows() const { return study.rows.names; }
  const fs::path file;
  const Study& study;
  const StudyIdentity identity;
  const StudyDatabaseOptions options;
  std::mutex mutex;
  std::optional<SQLite::Database> database;
  Clock::time_point deadline;  // of waiting for other programs
  bool made = false;           // by this object
  bool started = false;        // the file knows that this study is the newest

  std::set<Key> in_file;                 // whole trials of this study
  std::map<Key, FoundTrial> found;       // those that may be asked for
  std::vector<std::int64_t> taken_rows;  // not yet marked as asked for
  std::deque<KeptTrial> waiting;         // for a lock to go
  std::deque<KeptTrial> refused;         // for another reason: tried once more at the end
  std::string reason;                    // of the last that was not written
  Trouble trouble = Trouble::kOther;
  int written = 0;  // trials that this object put into it
  std::vector<std::int64_t> damaged_rows;
};

void StudyDatabase::State::Open() {
  CheckDatabasePlace(file);
  std::error_code ignored;
  made = fs::symlink_status(file, ignored).type() == fs::file_type::not_found;
  deadline = Clock::now() + options.patience;
  // Absolute, as SQLite takes `file:..` for an address.
  database.emplace(fs::absolute(file).string(), SQLite::OPEN_READWRITE | SQLite::OPEN_CREATE);
  sqlite3_busy_handler(
      database->getHandle(),
      [](void* self, int /*count*/) {
        const State& state = *static_cast<const State*>(self);
        if (Clock::now() >= state.deadline || !state.options.go_on()) return 0;
        std::this_thread::sleep_for(kLockPause);
        return 1;
      },
      this);
  database->exec("PRAGMA synchronous = NORMAL");
  database->exec("PRAGMA foreign_keys = OFF");  // rows of damaged trials may break them
  if (!HasTables(*database)) {
    MakeTables(*database);
  } else {
    SQLite::Transaction one_state(*database);
    CheckTables(file, *database);
    ReadTrials();
    one_state.commit();
  }
  // A file that cannot be written is found here. A lock may be gone when there is a trial.
  deadline = Clock::now();
  try {
    Write(nullptr);
  } catch (const SQLite::Exception& error) {
    if (TroubleOf(error) != Trouble::kLock) throw;
  }
}

void StudyDatabase::State::ReadTrials() {
  const std::int64_t first = study.scenario.seed;
  SQLite::Statement trials(*database,
                           "SELECT id, seed, problem, checksum FROM trial "
                           "WHERE controller = ? AND study = ? AND settings = ? "
                           "AND typeof(seed) = 'integer' ORDER BY seed");
  for (std::size_t controller = 0; controller < identity.controller_settings.size(); ++controller) {
    trials.reset();
    trials.bind(1, Controller(controller));
    trials.bind(2, identity.hash);
    trials.bind(3, identity.controller_settings[controller]);
    while (trials.executeStep()) {
      if (!options.go_on()) throw Cancelled{};
      const std::int64_t row = trials.getColumn(0).getInt64();
      const Key key{.controller = controller, .seed = trials.getColumn(1).getInt64()};
      if (key.seed >= first && key.seed < first + options.seeds) {
        std::optional<TrialOutcome> outcome = ReadTrial(row, trials.getColumn(2).getString());
        if (!outcome || ChecksumOf(ColumnsOf(key), *outcome) != TextOf(trials.getColumn(3))) {
          damaged_rows.push_back(row);
          continue;
        }
        found[key] = {.row = row, .outcome = std::move(*outcome)};
      }
      in_file.insert(key);
    }
  }
}

/// Nothing if there are rows that no trial has.
std::optional<TrialOutcome> StudyDatabase::State::ReadTrial(std::int64_t trial,
                                                            std::string problem) const {
  TrialOutcome outcome;
  outcome.health.problem = std::move(problem);
  outcome.health.ok = outcome.health.problem.empty();
  if (!ReadScores(trial, outcome.scores) || !ReadUntrusted(trial, outcome.untrusted_samples)) {
    return std::nullopt;
  }
  return outcome;
}

bool StudyDatabase::State::ReadScores(std::int64_t trial, Scores& scores) const {
  scores.summary.assign(Metrics().size(), std::numeric_limits<double>::quiet_NaN());
  scores.channels.assign(Rows().size(), scores.summary);
  SQLite::Statement query(*database, "SELECT channel, metric, value FROM score WHERE trial = ?");
  query.bind(1, trial);
  while (query.executeStep()) {
    const std::string_view channel = TextOf(query.getColumn(0));
    const auto row = std::ranges::find(Rows(), channel);
    const std::optional<std::size_t> metric = FindMetric(TextOf(query.getColumn(1)));
    const SQLite::Column value = query.getColumn(2);
    const bool summary = channel == kSummaryChannel;
    if ((!summary && row == Rows().end()) || !metric) return false;
    if (!value.isFloat() || !std::isfinite(value.getDouble())) return false;
    std::vector<double>& of_channel =
        summary ? scores.summary : scores.channels[static_cast<std::size_t>(row - Rows().begin())];
    of_channel[*metric] = value.getDouble();
  }
  return true;
}

bool StudyDatabase::State::ReadUntrusted(std::int64_t trial,
                                         std::vector<std::int64_t>& samples) const {
  samples.assign(Channels().size(), 0);
  SQLite::Statement query(*database, "SELECT channel, samples FROM untrusted WHERE trial = ?");
  query.bind(1, trial);
  while (query.executeStep()) {
    const auto channel = std::ranges::find(Channels(), TextOf(query.getColumn(0)));
    const SQLite::Column count = query.getColumn(1);
    if (channel == Channels().end() || !count.isInteger()) return false;
    samples[static_cast<std::size_t>(channel - Channels().begin())] = count.getInt64();
  }
  return true;
}

/// Once per study: puts it into its table. Its trials become the newest as they are asked for.
void StudyDatabase::State::Start() {
  SQLite::Statement add(*database,
                        "INSERT INTO study VALUES (?, ?) "
                        "ON CONFLICT (hash) DO UPDATE SET scenario = excluded.scenario");
  add.bind(1, identity.hash);
  add.bind(2, identity.shared_settings);
  add.exec();
  database->exec("UPDATE trial SET newest = 0 WHERE newest <> 0");
  if (!damaged_rows.empty()) RemoveDamagedTrials();
}

/// With what is left of them. Where a key is damaged, rows are out of order, and SQLite does not
/// find what lies behind them: so all rows are written anew.
void StudyDatabase::State::RemoveDamagedTrials() {
  SQLite::Statement remove(*database, "DELETE FROM trial WHERE id = ?");
  for (const std::int64_t row : damaged_rows) {
    remove.bind(1, row);
    remove.exec();
    remove.reset();
  }
  for (const char* table : {"score", "untrusted"}) {
    database->exec(
        fmt::format("CREATE TABLE temp.whole AS SELECT * FROM main.{0} "
                    "WHERE +trial IN (SELECT id FROM main.trial);"  // +: one by one, not by key
                    "DELETE FROM main.{0};"
                    "INSERT OR IGNORE INTO main.{0} SELECT * FROM temp.whole;"
                    "DROP TABLE temp.whole",
                    table));
  }
}

/// In one transaction: what this study is, which of its trials were asked for, and a trial, if
/// there is one. Waits for other programs until the deadline.
void StudyDatabase::State::Write(const KeptTrial* kept) {
  // Exclusive from the start: if another program reads, nothing is done in vain.
  const Unbroken unbroken;  // or its journal would be left
  SQLite::Transaction transaction(*database, SQLite::TransactionBehavior::EXCLUSIVE);
  if (!started) Start();
  SQLite::Statement mark(*database, "UPDATE trial SET newest = 1 WHERE id = ?");
  for (const std::int64_t row : taken_rows) {
    mark.bind(1, row);
    mark.exec();
    mark.reset();
  }
  if (kept != nullptr) {
    const TrialColumns columns = ColumnsOf(kept->key);
    RemoveTrial(columns, *database);
    SQLite::Statement add(*database,
                          "INSERT INTO trial (study, controller, settings, seed, problem, newest, "
                          "checksum) VALUES (?, ?, ?, ?, ?, 1, ?)");
    Bind(columns, add);
    add.bind(5, kept->outcome.health.problem);
    add.bind(6, ChecksumOf(columns, kept->outcome));
    add.exec();
    AddScores(database->getLastInsertRowid(), kept->outcome);
  }
  transaction.commit();
  started = true;
  taken_rows.clear();
  if (kept == nullptr) return;
  in_file.insert(kept->key);
  ++written;
}

void StudyDatabase::State::AddScores(std::int64_t trial, const TrialOutcome& outcome) {
  SQLite::Statement add(*database, "INSERT INTO score VALUES (?, ?, ?, ?)");
  const auto add_all = [&](const std::string& channel, const std::vector<double>& values) {
    for (std::size_t m = 0; m < values.size(); ++m) {
      if (!std::isfinite(values[m])) continue;  // what is not there is no score
      add.bind(1, trial);
      add.bind(2, channel);
      add.bind(3, std::string(Metrics()[m].key));
      add.bind(4, values[m]);
      add.exec();
      add.reset();
    }
  };
  add_all(std::string(kSummaryChannel), outcome.scores.summary);
  for (std::size_t row = 0; row < Rows().size(); ++row) {
    add_all(Rows()[row], outcome.scores.channels[row]);
  }
  SQLite::Statement count(*database, "INSERT INTO untrusted VALUES (?, ?, ?)");
  for (std::size_t c = 0; c < Channels().size(); ++c) {
    count.bind(1, trial);
    count.bind(2, Channels()[c]);
    count.bind(3, static_cast<std::int64_t>(outcome.untrusted_samples[c]));
    count.exec();
    count.reset();
  }
}

/// Writes the trials that wait, one transaction each, until there is a lock or none is left.
/// Errors: SQLite::Exception for a full disk.
void StudyDatabase::State::WriteWaiting() {
  while (!waiting.empty()) {
    try {
      Write(&waiting.front());
    } catch (const SQLite::Exception& error) {
      trouble = TroubleOf(error);
      reason = error.what();
      if (trouble == Trouble::kFullDisk) throw;
      if (trouble == Trouble::kLock) return;
      refused.push_back(std::move(waiting.front()));
    }
    waiting.pop_front();
  }
}

/// Writes all that the file lacks. Errors: SQLite::Exception.
void StudyDatabase::State::WriteAll() {
  std::ranges::move(refused, std::back_inserter(waiting));
  refused.clear();
  WriteWaiting();
  if (waiting.empty() && !taken_rows.empty()) Write(nullptr);
}

StudyDatabase::State::~State() {
  if (!database) return;
  deadline = Clock::now();
  try {
    WriteAll();
  } catch (const std::exception&) {  // NOLINT(bugprone-empty-catch): Finish() would have told
  }
  database.reset();
  // What is not there by this object's own doing is never judged by a question to the file, which
  // may fail.
  const bool of_no_use = made && written == 0 && waiting.empty() && refused.empty();
  std::error_code ignored;
  if (of_no_use) fs::remove(file, ignored);
}

StudyDatabase::StudyDatabase(fs::path file, const Study& study, StudyDatabaseOptions options)
    : StudyDatabase(std::move(file), study, IdentityOf(study), std::move(options)) {}

StudyDatabase::StudyDatabase(fs::path file, const Study& study, StudyIdentity identity,
                             StudyDatabaseOptions options)
    : state_(std::make_unique<State>(std::move(file), study, std::move(identity),
                                     std::move(options))) {
  try {
    state_->Open();
  } catch (const SQLite::Exception& error) {
    if (!state_->options.go_on()) throw Cancelled{};
    ThrowCannotOpen(state_->file, error);
  }
}

StudyDatabase::~StudyDatabase() = default;

std::optional<TrialOutcome> StudyDatabase::Take(int seed, std::size_t controller) {
  State& state = *state_;
  const std::lock_guard lock(state.mutex);
  const auto trial = state.found.find({.controller = controller, .seed = seed});
  if (trial == state.found.end()) return std::nullopt;
  state.taken_rows.push_back(trial->second.row);
  TrialOutcome outcome = std::move(trial->second.outcome);
  state.found.erase(trial);
  return outcome;
}

void StudyDatabase::Keep(int seed, std::size_t controller, const TrialOutcome& outcome) {
  State& state = *state_;
  const std::lock_guard lock(state.mutex);
  state.waiting.push_back({.key = {.controller = controller, .seed = seed}, .outcome = outcome});
  state.deadline = Clock::now();
  try {
    state.WriteWaiting();
  } catch (const SQLite::Exception&) {
    state.waiting.pop_back();
    throw RunError(
        fmt::format("{}: the disk is full; the same command goes on from the {} trials "
                    "that are kept",
                    state.file.string(), state.in_file.size()));
  }
}

std::optional<std::string> StudyDatabase::Finish() {
  State& state = *state_;
  const std::lock_guard lock(state.mutex);
  state.deadline = Clock::now() + state.options.patience;
  try {
    state.WriteAll();
  } catch (const SQLite::Exception& error) {
    state.trouble = TroubleOf(error);
    state.reason = error.what();
  }
  const std::size_t missing = state.waiting.size() + state.refused.size() + state.taken_rows.size();
  if (missing == 0) return std::nullopt;
  const std::string why = state.trouble == Trouble::kLock
                              ? "another program (or its network folder) keeps it locked"
                              : state.reason;
  return fmt::format("{}: lacks {} trial{} of this comparison: {}; the same command adds them",
                     state.file.string(), missing, missing == 1 ? "" : "s", why);
}

int StudyDatabase::TrialCount() const {
  const std::lock_guard lock(state_->mutex);
  return static_cast<int>(state_->in_file.size());
}

int StudyDatabase::DamagedCount() const { return static_cast<int>(state_->damaged_rows.size()); }

}  // namespace gauntlet::sim
