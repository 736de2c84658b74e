#include "sim/study/study_database.h"

#include <SQLiteCpp/SQLiteCpp.h>
#include <fmt/format.h>
#include <sqlite3.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <limits>
#include <mutex>
#include <vector>

#include "sim/base/error.h"
#include "sim/base/hash.h"

namespace gauntlet::sim {
namespace {

namespace fs = std::filesystem;

/// Raised whenever the tables change.
constexpr int kFormat = 3;
/// Another program may be reading.
constexpr int kPatienceMs = 10'000;
constexpr const char* kSummary = "summary";

constexpr const char* kTables = R"(
  CREATE TABLE study (
    hash TEXT PRIMARY KEY,    -- of glove, hand, event and program
    scenario TEXT NOT NULL    -- with every value used, as YAML; without its controllers
  );
  CREATE TABLE trial (
    id INTEGER PRIMARY KEY,
    seed INTEGER NOT NULL,
    controller TEXT NOT NULL,
    study TEXT NOT NULL REFERENCES study (hash),
    settings TEXT NOT NULL,   -- hash of the controller's settings
    problem TEXT NOT NULL,    -- why the hand stopped early; empty if all was well
    newest INTEGER NOT NULL,  -- 1: of what was asked for last, 0: of an earlier study or setting
    UNIQUE (study, controller, settings, seed)
  );
  CREATE TABLE score (
    trial INTEGER NOT NULL REFERENCES trial (id) ON DELETE CASCADE,
    channel TEXT NOT NULL,    -- joint, motor or cable; 'summary' is the mean over all
    metric TEXT NOT NULL,
    value REAL NOT NULL,
    PRIMARY KEY (trial, channel, metric)
  ) WITHOUT ROWID;
  CREATE TABLE untrusted (
    trial INTEGER NOT NULL REFERENCES trial (id) ON DELETE CASCADE,
    channel TEXT NOT NULL,
    samples INTEGER NOT NULL, -- samples of the glove that the controller did not believe
    PRIMARY KEY (trial, channel)
  ) WITHOUT ROWID;
  CREATE VIEW all_scores AS
    SELECT study, settings, seed, controller, channel, metric, value
    FROM score JOIN trial ON trial.id = score.trial;
  CREATE VIEW scores AS       -- of what was asked for last
    SELECT seed, controller, channel, metric, value
    FROM score JOIN trial ON trial.id = score.trial WHERE newest = 1;
)";

/// The program's own bytes: another build may compute other bytes.
std::string HashOfProgram() {
  std::ifstream file("/proc/self/exe", std::ios::binary);
  Hash content;
  content.Add(std::string(std::istreambuf_iterator<char>(file), {}));
  return content.Text();
}

/// What all trials of a study share, whatever their seed, as text.
std::string SharedSettings(const Study& study) {
  Scenario scenario = study.scenario;
  scenario.name.clear();
  scenario.question.clear();
  scenario.video = {};
  scenario.made_with = {};
  scenario.controllers.clear();
  scenario.baseline.clear();  // judges trials, and changes none
  return ScenarioToYaml(scenario);
}

std::string HashOfStudy(const Study& study) {
  Hash hash;
  hash.Add(SharedSettings(study));
  hash.Add(study.hand->Hash());
  hash.Add(study.glove_hash);  // holds the content of a recording, too
  hash.Add(HashOfProgram());
  return hash.Text();
}

std::string HashOfSettings(const NamedController& controller) {
  Scenario scenario;
  scenario.controllers = {controller};
  Hash hash;
  hash.Add(ScenarioToYaml(scenario));
  return hash.Text();
}

}  // namespace

struct StudyDatabase::State {
  State(fs::path path, const Study& s) : file(std::move(path)), study(s) {
    study_hash = HashOfStudy(study);
    for (const NamedController& named : study.scenario.controllers) {
      settings.push_back(HashOfSettings(named));
    }
  }

  void Open(bool make);
  std::int64_t FindTrial(int seed, std::size_t controller);
  void AddScores(std::int64_t trial, const TrialOutcome& outcome);
  const std::string& Controller(std::size_t index) const {
    return study.scenario.controllers[index].name;
  }
  const std::vector<std::string>& Channels() const { return study.channel_names(); }
  const std::vector<std::string>& Rows() const { return study.rows.names; }
  void StartStudy();

  /// Runs `action` on the database, one thread at a time; what SQLite throws becomes one line.
  template <class Action>
  auto Guarded(const Action& action) {
    const std::lock_guard lock(mutex);
    try {
      return action();
    } catch (const SQLite::Exception& error) {
      const std::string line = fmt::format("{}: {}", file.string(), error.what());
      if (error.getErrorCode() == SQLITE_NOTADB || error.getErrorCode() == SQLITE_CORRUPT) {
        throw UserError(line + "; remove it, or name another folder by --out");
      }
      throw RunError(line);
    }
  }

  fs::path file;
  const Study& study;
  std::string study_hash;
  std::vector<std::string> settings;  // hashes, per controller
  std::mutex mutex;
  std::optional<SQLite::Database> database;
  bool made = false;
  bool started = false;
};

void StudyDatabase::State::Open(bool make) {
  if (database) return;
  const bool exists = fs::exists(file);
  if (!exists && !make) return;
  database.emplace(file.string(), SQLite::OPEN_READWRITE | (make ? SQLite::OPEN_CREATE : 0),
                   kPatienceMs);
  database->exec("PRAGMA foreign_keys = ON");
  database->exec("PRAGMA synchronous = NORMAL");
  if (!exists || fs::file_size(file) == 0) {
    made = !exists;
    SQLite::Transaction transaction(*database);
    database->exec(kTables);
    database->exec(fmt::format("PRAGMA user_version = {}", kFormat));
    transaction.commit();
  } else if (database->execAndGet("PRAGMA user_version").getInt() != kFormat) {
    database.reset();
    throw UserError(
        fmt::format("{}: is not a study database of this version of Gauntlet; remove it, or name "
                    "another folder by "
                    "--out",
                    file.string()));
  }
}

/// Once per study: puts it into its table. Its trials are started as they are asked for.
void StudyDatabase::State::StartStudy() {
  if (started) return;
  SQLite::Statement add(*database, "INSERT OR IGNORE INTO study VALUES (?, ?)");
  add.bind(1, study_hash);
  add.bind(2, SharedSettings(study));
  add.exec();
  database->exec("UPDATE trial SET newest = 0");
  started = true;
}

std::int64_t StudyDatabase::State::FindTrial(int seed, std::size_t controller) {
  SQLite::Statement find(*database,
                         "SELECT id FROM trial WHERE seed = ? AND controller = ? AND study = ? AND "
                         "settings = ?");
  find.bind(1, seed);
  find.bind(2, Controller(controller));
  find.bind(3, study_hash);
  find.bind(4, settings[controller]);
  return find.executeStep() ? find.getColumn(0).getInt64() : 0;
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
  add_all(kSummary, outcome.scores.summary);
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

StudyDatabase::StudyDatabase(fs::path file, const Study& study)
    : state_(std::make_unique<State>(std::move(file), study)) {
  state_->Guarded([&] { state_->Open(false); });
}
StudyDatabase::~StudyDatabase() {
  // A file without a trial is of no use: the disk was full, say.
  State& state = *state_;
  if (!state.made) return;
  bool empty = false;
  try {
    empty = state.database->execAndGet("SELECT count(*) FROM trial").getInt() == 0;
  } catch (const SQLite::Exception&) {
    empty = true;  // not even the tables are there
  }
  state.database.reset();
  std::error_code ignored;
  if (empty) fs::remove(state.file, ignored);
}

std::optional<TrialOutcome> StudyDatabase::Find(int seed, std::size_t controller) {
  State& state = *state_;
  return state.Guarded([&]() -> std::optional<TrialOutcome> {
    if (!state.database) return std::nullopt;
    const std::int64_t trial = state.FindTrial(seed, controller);
    if (trial == 0) return std::nullopt;
    SQLite::Transaction transaction(*state.database);
    state.StartStudy();
    SQLite::Statement mark(*state.database, "UPDATE trial SET newest = 1 WHERE id = ?");
    mark.bind(1, trial);
    mark.exec();
    transaction.commit();

    const double missing = std::numeric_limits<double>::quiet_NaN();
    TrialOutcome outcome;
    outcome.scores.summary.assign(Metrics().size(), missing);
    outcome.scores.channels.assign(state.Rows().size(), outcome.scores.summary);
    outcome.untrusted_samples.assign(state.Channels().size(), 0);
    const auto index_in = [](const std::vector<std::string>& names, const std::string& name) {
      return static_cast<std::size_t>(std::ranges::find(names, name) - names.begin());
    };

    SQLite::Statement health(*state.database, "SELECT problem FROM trial WHERE id = ?");
    health.bind(1, trial);
    health.executeStep();
    outcome.health.problem = health.getColumn(0).getString();
    outcome.health.ok = outcome.health.problem.empty();

    SQLite::Statement scores(*state.database,
                             "SELECT channel, metric, value FROM score WHERE trial = ?");
    scores.bind(1, trial);
    while (scores.executeStep()) {
      const std::string channel = scores.getColumn(0).getString();
      const auto metric = FindMetric(scores.getColumn(1).getString());
      const double value = scores.getColumn(2).getDouble();
      const std::size_t row = index_in(state.Rows(), channel);
      if (!metric) continue;
      if (channel == kSummary) outcome.scores.summary[*metric] = value;
      if (row < outcome.scores.channels.size()) outcome.scores.channels[row][*metric] = value;
    }
    SQLite::Statement untrusted(*state.database,
                                "SELECT channel, samples FROM untrusted WHERE trial = ?");
    untrusted.bind(1, trial);
    while (untrusted.executeStep()) {
      const std::size_t index = index_in(state.Channels(), untrusted.getColumn(0).getString());
      if (index >= outcome.untrusted_samples.size()) continue;
      outcome.untrusted_samples[index] = untrusted.getColumn(1).getInt64();
    }
    return outcome;
  });
}

void StudyDatabase::Keep(int seed, std::size_t controller, const TrialOutcome& outcome) {
  State& state = *state_;
  state.Guarded([&] {
    state.Open(true);
    SQLite::Transaction transaction(*state.database);
    state.StartStudy();
    if (const std::int64_t known = state.FindTrial(seed, controller); known != 0) {
      SQLite::Statement remove(*state.database, "DELETE FROM trial WHERE id = ?");
      remove.bind(1, known);
      remove.exec();
    }
    SQLite::Statement add(*state.database,
                          "INSERT INTO trial (seed, controller, study, settings, problem, newest) "
                          "VALUES (?, ?, ?, ?, ?, 1)");
    add.bind(1, seed);
    add.bind(2, state.Controller(controller));
    add.bind(3, state.study_hash);
    add.bind(4, state.settings[controller]);
    add.bind(5, outcome.health.problem);
    add.exec();
    state.AddScores(state.database->getLastInsertRowid(), outcome);
    transaction.commit();
  });
}

int StudyDatabase::TrialCount() {
  State& state = *state_;
  return state.Guarded([&] {
    if (!state.database) return 0;
    int count = 0;
    for (std::size_t c = 0; c < state.settings.size(); ++c) {
      SQLite::Statement query(
          *state.database,
          "SELECT count(*) FROM trial WHERE controller = ? AND study = ? AND settings = ?");
      query.bind(1, state.Controller(c));
      query.bind(2, state.study_hash);
      query.bind(3, state.settings[c]);
      query.executeStep();
      count += query.getColumn(0).getInt();
    }
    return count;
  });
}

}  // namespace gauntlet::sim
