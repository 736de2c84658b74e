#include "sim/study/trial_table/sweep_database.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <limits>
#include <mutex>
#include <span>
#include <sstream>

#include "sim/base/error.h"
#include "sim/base/hash.h"
#include "sim/base/input_file.h"
#include "sim/base/stop.h"
#include "sim/study/trial_table/study_schema.h"
#include "sim/study/trial_table/trial_table.h"

namespace gauntlet::sim {
namespace {

namespace fs = std::filesystem;

std::string ChecksumOfMeans(const TrialKey& key, const TrialOutcome& outcome,
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

using Values = std::vector<std::pair<std::string, std::string>>;

void WriteCell(const std::string& sweep, const SweepCellRecord& cell, const Values& values,
               TrialTable& table) {
  table.Run("INSERT OR REPLACE INTO cell VALUES (?, ?, ?, ?, ?, ?, ?)", sweep, cell.number,
            cell.controller, cell.study, cell.settings,
            fmt::format("{}", fmt::join(cell.motions, " ")), cell.problem);
  for (const auto& [key, text] : values) {
    table.Run("INSERT OR REPLACE INTO cell_value VALUES (?, ?, ?, ?)", sweep, cell.number, key,
              text);
  }
}

}  // namespace

struct SweepDatabase::State {
  State(fs::path file, std::string name, std::vector<std::size_t> metrics)
      : sweep(std::move(name)),
        table(std::move(file),
              {.kept_for = "sweep", .metrics = std::move(metrics), .checksum = ChecksumOfMeans}) {}

  const std::string sweep;
  TrialTable table;
  std::mutex mutex;
};

SweepDatabase::SweepDatabase(fs::path file, std::string sweep, std::vector<std::size_t> metrics)
    : state_(std::make_unique<State>(std::move(file), std::move(sweep), std::move(metrics))) {}

SweepDatabase::~SweepDatabase() = default;

std::vector<std::optional<TrialOutcome>> SweepDatabase::Read(const TrialKey& first, int seeds) {
  const std::lock_guard lock(state_->mutex);
  return state_->table.Read(first, seeds);
}

void SweepDatabase::ReadTogether(const std::function<void()>& work) {
  state_->table.ReadTogether(work);
}

void SweepDatabase::Keep(const TrialKey& key, const TrialOutcome& outcome) {
  const std::lock_guard lock(state_->mutex);
  state_->table.Keep(key, {.scores = {.summary = outcome.scores.summary, .channels = {}},
                           .health = outcome.health,
                           .untrusted_samples = {}});
}

void SweepDatabase::AddStudy(const std::string& study, const std::string& scenario) {
  const std::lock_guard lock(state_->mutex);
  state_->table.Add([study, scenario](TrialTable& table) {
    table.Run("INSERT OR IGNORE INTO study VALUES (?, ?)", study, scenario);
  });
}

void SweepDatabase::AddCell(const SweepCellRecord& cell, const Values& values) {
  const std::lock_guard lock(state_->mutex);
  state_->table.KeepFile();
  state_->table.Add([&sweep = state_->sweep, cell, values](TrialTable& table) {
    WriteCell(sweep, cell, values, table);
  });
}

std::vector<SweepCellRecord> SweepDatabase::CellAt(std::int64_t number) {
  const std::lock_guard lock(state_->mutex);
  std::vector<SweepCellRecord> records;
  try {
    auto query = state_->table.Prepare(
        "SELECT controller, study, settings, motions, problem FROM cell "
        "WHERE sweep = ? AND number = ? ORDER BY controller",
        state_->sweep, number);
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
    ThrowCannotOpen(state_->table.file(), error);
  }
  return records;
}

void SweepDatabase::Flush() {
  const std::lock_guard lock(state_->mutex);
  if (const auto lacks = state_->table.Finish()) throw RunError(*lacks);
}

void SweepDatabase::Collect(const fs::path& other) {
  const std::lock_guard lock(state_->mutex);
  std::error_code ignored;
  const fs::file_status status = fs::symlink_status(other, ignored);
  if (!fs::is_regular_file(status)) {
    throw UserError({.place = "--collect",
                     .key = other.string(),
                     .problem = fs::exists(status) ? "must be a file, not a link or a device"
                                                   : "there is no such file"});
  }
  CheckDatabasePlace(InputFile(other));
  const std::string path = InRealFolder(other).string();
  SQLite::Database& ours = state_->table.database();
  try {
    {
      SQLite::Database there(path, SQLite::OPEN_READONLY | SQLite::OPEN_NOFOLLOW);
      CheckTables(other, there);
    }
    SQLite::Statement attach(ours, "ATTACH ? AS other");
    attach.bind(1, path);
    attach.exec();
    const Unbroken unbroken;
    SQLite::Transaction transaction(ours, SQLite::TransactionBehavior::EXCLUSIVE);
    constexpr const char* kSame =
        "JOIN other.trial AS theirs ON theirs.id = rows.trial JOIN main.trial AS ours "
        "USING (study, controller, settings, seed)";
    ours.exec("INSERT OR IGNORE INTO main.study SELECT * FROM other.study");
    ours.exec(
        "INSERT OR IGNORE INTO main.trial (seed, controller, study, settings, problem, newest, "
        "checksum) SELECT seed, controller, study, settings, problem, newest, checksum "
        "FROM other.trial");
    ours.exec(fmt::format(
        "INSERT OR IGNORE INTO main.score SELECT ours.id, rows.channel, rows.metric, rows.value "
        "FROM other.score AS rows {}",
        kSame));
    ours.exec(fmt::format(
        "INSERT OR IGNORE INTO main.untrusted SELECT ours.id, rows.channel, rows.samples "
        "FROM other.untrusted AS rows {}",
        kSame));
    ours.exec("INSERT OR IGNORE INTO main.cell SELECT * FROM other.cell");
    ours.exec("INSERT OR IGNORE INTO main.cell_value SELECT * FROM other.cell_value");
    transaction.commit();
    state_->table.KeepFile();
    ours.exec("DETACH other");
  } catch (const SQLite::Exception& error) {
    ThrowCannotOpen(other, error);
  }
}

std::int64_t SweepDatabase::TrialCount() {
  const std::lock_guard lock(state_->mutex);
  return state_->table.database().execAndGet("SELECT count(*) FROM trial").getInt64();
}

int SweepDatabase::DamagedCount() const { return state_->table.damaged(); }

}  // namespace gauntlet::sim
