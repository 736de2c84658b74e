#include "sim/study/trial_table/study_schema.h"

#include <fmt/format.h>
#include <sqlite3.h>

#include <fstream>
#include <iterator>
#include <map>

#include "sim/base/stop.h"

namespace gauntlet::sim {
namespace {

namespace fs = std::filesystem;

/// Raised whenever the tables change.
constexpr int kTablesVersion = 5;

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
    checksum TEXT NOT NULL,   -- of all the rest, with the rows of score and untrusted
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
  CREATE TABLE cell (         -- of a sweep: one choice of settings, and whose trials are its own
    sweep TEXT NOT NULL,      -- hash of the study file and of all that it begins with
    number INTEGER NOT NULL,  -- from 0, in the order of cells.csv
    controller TEXT NOT NULL, -- empty where the cell could not be built
    study TEXT NOT NULL,
    settings TEXT NOT NULL,
    motions TEXT NOT NULL,    -- seed by seed: the number of what the wearer did
    problem TEXT NOT NULL,    -- why it could not be built; empty if it could
    PRIMARY KEY (sweep, number, controller)
  ) WITHOUT ROWID;
  CREATE TABLE cell_value (
    sweep TEXT NOT NULL,
    number INTEGER NOT NULL,
    key TEXT NOT NULL,        -- as --set takes it
    value TEXT NOT NULL,
    PRIMARY KEY (sweep, number, key)
  ) WITHOUT ROWID;
  CREATE VIEW all_scores AS
    SELECT study, settings, seed, controller, channel, metric, value
    FROM score JOIN trial ON trial.id = score.trial;
  CREATE VIEW scores AS       -- of what was asked for last
    SELECT seed, controller, channel, metric, value
    FROM score JOIN trial ON trial.id = score.trial WHERE newest = 1;
  CREATE VIEW cell_scores AS
    SELECT sweep, number, cell.controller, seed, metric, value
    FROM cell JOIN trial USING (study, settings) JOIN score ON score.trial = trial.id
    WHERE trial.controller = cell.controller AND channel = 'summary';
)";

/// The definitions of tables and views by name, as SQLite keeps them.
std::map<std::string, std::string> Definitions(const SQLite::Database& database) {
  std::map<std::string, std::string> definitions;
  SQLite::Statement query(database, "SELECT name, sql FROM sqlite_schema WHERE sql IS NOT NULL");
  while (query.executeStep()) {
    definitions[query.getColumn(0).getString()] = query.getColumn(1).getString();
  }
  return definitions;
}

/// True for a journal of several databases. It names a file, which SQLite removes after it has
/// undone the transaction. Gauntlet makes none. Source: sqlite.org/fileformat2.html, 3.
bool NamesAnotherFile(const fs::path& journal) {
  constexpr std::string_view kMark = "\xd9\xd5\x05\xf9\x20\xa1\x63\xd7";
  char end[kMark.size()] = {};
  std::ifstream file(journal, std::ios::binary);
  file.seekg(-std::ssize(kMark), std::ios::end).read(end, kMark.size());
  return file && std::string_view(end, kMark.size()) == kMark;
}

}  // namespace

Trouble TroubleOf(const SQLite::Exception& error) {
  switch (error.getErrorCode() & 0xFF) {  // the rest says where
    case SQLITE_BUSY:
    case SQLITE_LOCKED:
      return Trouble::kLock;
    case SQLITE_CORRUPT:
    case SQLITE_NOTADB:
      return Trouble::kDamage;
    case SQLITE_FULL:
      return Trouble::kFullDisk;
    default:
      return Trouble::kOther;
  }
}

UserError NotUsable(const fs::path& file, std::string_view what) {
  return UserError(
      fmt::format("{}: {}; remove it, or name another folder by --out", file.string(), what));
}

void CheckDatabasePlace(const fs::path& file) {
  constexpr std::string_view kJournal = "-journal";
  std::error_code ignored;
  for (const std::string_view ending : {std::string_view(), kJournal}) {
    const fs::path place = fs::path(file) += ending;
    const fs::file_status status = fs::symlink_status(place, ignored);
    if (fs::is_symlink(status)) throw NotUsable(place, "is a symbolic link");
    if (fs::exists(status) && !fs::is_regular_file(status)) {
      throw NotUsable(place, "is not a file of its own");
    }
    if (!ending.empty() && NamesAnotherFile(place)) {
      throw NotUsable(place, "names a file that SQLite would remove");
    }
  }
  // The journal beside it has the longest name.
  const std::size_t longest = static_cast<std::size_t>(sqlite3_vfs_find(nullptr)->mxPathname);
  const std::size_t length = InRealFolder(file).native().size();
  if (length + kJournal.size() > longest) {
    throw UserError(
        {.place = "--out",
         .problem = fmt::format("the path of study.db has {} bytes, SQLite takes at most "
                                "{}; name a folder with a shorter path",
                                length, longest - kJournal.size())});
  }
}

fs::path InRealFolder(const fs::path& file) {
  std::error_code ignored;
  const fs::path whole = fs::absolute(file);
  const fs::path folder = fs::weakly_canonical(whole.parent_path(), ignored);
  return (folder.empty() ? whole.parent_path() : folder) / whole.filename();
}

bool HasTables(SQLite::Database& database) {
  return database.execAndGet("SELECT count(*) FROM sqlite_schema").getInt() > 0;
}

void MakeTables(SQLite::Database& database) {
  const Unbroken unbroken;  // or its journal would be left
  SQLite::Transaction transaction(database, SQLite::TransactionBehavior::EXCLUSIVE);
  database.exec(kTables);
  database.exec(fmt::format("PRAGMA user_version = {}", kTablesVersion));
  transaction.commit();
}

void CheckTables(const fs::path& file, SQLite::Database& database) {
  if (database.execAndGet("PRAGMA user_version").getInt() != kTablesVersion) {
    throw NotUsable(file, "is not a study database of this version of Gauntlet");
  }
  SQLite::Database intact(":memory:", SQLite::OPEN_READWRITE | SQLite::OPEN_CREATE);
  intact.exec(kTables);
  const std::map<std::string, std::string> here = Definitions(database);
  for (const auto& [name, definition] : Definitions(intact)) {
    const auto found_here = here.find(name);
    if (found_here == here.end()) {
      throw NotUsable(file, fmt::format("has no table or view {}", name));
    }
    if (found_here->second != definition) {
      throw NotUsable(file, fmt::format("its table or view {} is not as Gauntlet makes it", name));
    }
  }
  // Scores have their checksums; this is for trials that are in the table or in its index only.
  if (database.execAndGet("PRAGMA integrity_check(trial)").getString() != "ok") {
    throw NotUsable(file, "is damaged");
  }
}

void ThrowCannotOpen(const fs::path& file, const SQLite::Exception& error) {
  const std::string name = file.string();
  switch (TroubleOf(error)) {
    case Trouble::kDamage:
      // SQLite quotes what it could not read, over several lines.
      throw NotUsable(file,
                      error.getErrorCode() == SQLITE_NOTADB ? "is not a database" : "is damaged");
    case Trouble::kLock:
      throw RunError(fmt::format("{}: {}; try again when it is free", name, kLockedByAnother));
    case Trouble::kFullDisk:
      throw RunError(name + ": the disk is full");
    case Trouble::kOther:
      break;
  }
  throw RunError(fmt::format("{}: cannot be used: {}", name, error.what()));
}

}  // namespace gauntlet::sim
