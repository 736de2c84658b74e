#pragma once

#include <SQLiteCpp/SQLiteCpp.h>
#include <SQLiteCpp/VariadicBind.h>

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "sim/study/study_identity.h"
#include "sim/study/study_run.h"

namespace gauntlet::sim {

/// "kept in FILE: the same command continues from there".
std::string KeptIn(const std::filesystem::path& file);

/// The parts of a trial that a database keeps, and how it treats its file.
struct TrialTableOptions {
  std::string_view kept_for;               // "comparison"; for messages
  std::vector<std::size_t> metrics;        // in Metrics()
  std::vector<std::string> rows = {};      // of the scores, beside the summary
  std::vector<std::string> channels = {};  // with a count of untrusted samples
  /// Over the key and all parts that are kept.
  std::string (*checksum)(const TrialKey&, const TrialOutcome&,
                          const std::vector<std::size_t>& metrics) = nullptr;
  std::chrono::milliseconds patience{10'000};     // longest wait for the lock of another program
  std::chrono::milliseconds between_writes{250};  // trials of so long are written together
};

/// The trials in a `study.db`, for comparisons and sweeps: opening, locks, checksums, damage, full
/// disks. The tables are in study_schema.h.
///
/// Changes wait and are written together, in one transaction. If the file does not take them, they
/// wait for the next write, and in the end for Finish(): a lock of another program delays trials in
/// the file and loses none. Only a full disk ends the work, since no other file could be written
/// either. (The journal is SQLite's rollback journal: write-ahead logs do not work on network
/// folders and leave files beside.)
///
/// A trial has a checksum. One with another checksum is damaged: it is not read, and removed by the
/// next write. A file that this object made and that got nothing is removed again.
///
/// One thread at a time. Errors of constructor and reading: UserError for a file that is not such a
/// database, is damaged or a symbolic link; RunError for one that cannot be read or written;
/// Cancelled.
class TrialTable {
 public:
  using Change = std::function<void(TrialTable&)>;
  struct Reset {
    void operator()(SQLite::Statement* statement) const { statement->tryReset(); }
  };
  /// Resets at the end of the scope: an open statement would hold the lock of the file.
  using Prepared = std::unique_ptr<SQLite::Statement, Reset>;

  TrialTable(std::filesystem::path file, TrialTableOptions options);
  /// Tries to write the rest, without waiting for other programs.
  ~TrialTable();
  TrialTable(const TrialTable&) = delete;
  TrialTable& operator=(const TrialTable&) = delete;

  /// The trials of `first` and of the seeds after it, as far as the file has them undamaged.
  std::vector<std::optional<TrialOutcome>> Read(const TrialKey& first, int seeds);
  /// Runs `work`, which only reads, with one lock for all of its queries.
  void ReadTogether(const std::function<void()>& work);

  /// Adds or replaces a trial. Does not wait for other programs. Errors: RunError for a full disk.
  void Keep(TrialKey key, TrialOutcome outcome);
  /// Another change for the next write; before its trials.
  void Add(Change change) { changes_.push_back(std::move(change)); }
  /// Writes now, unless another program has locked the file. Errors: as of the constructor.
  void WriteUnlessLocked();
  /// Writes the rest and waits for other programs. Returns what the file lacks, why, and what to
  /// do about it, as one line; nothing if it lacks nothing.
  std::optional<std::string> Finish();
  /// The file stays though it has no trial.
  void KeepFile() { used_ = true; }

  /// Trials that were written and not there before.
  int added() const { return added_; }
  /// Trials that were found damaged.
  int damaged() const { return damaged_; }
  const std::filesystem::path& file() const { return file_; }
  SQLite::Database& database() { return *database_; }
  /// A statement with its values in order. It is made once; `sql` is a literal.
  /// Errors: SQLite::Exception.
  template <class... Values>
  Prepared Prepare(std::string_view sql, const Values&... values) {
    Prepared statement = Find(sql);
    SQLite::bind(*statement, values...);
    return statement;
  }
  /// Runs a statement that gives no rows. Errors: SQLite::Exception.
  template <class... Values>
  void Run(std::string_view sql, const Values&... values) {
    Prepare(sql, values...)->exec();
  }

 private:
  Prepared Find(std::string_view sql);
  void Open();
  void Close();
  bool ReadParts(std::int64_t row, TrialOutcome& outcome);
  std::optional<SQLite::Exception> TryToWrite(bool waits);
  void WriteAll();
  void RemoveDamaged();
  bool Remove(const TrialKey& key);
  void Insert(const TrialKey& key, const TrialOutcome& outcome);

  const std::filesystem::path file_;
  const TrialTableOptions options_;
  bool made_;  // the file, by this object
  bool used_ = false;
  std::optional<SQLite::Database> database_;
  std::map<std::string_view, SQLite::Statement> statements_;  // by their SQL
  bool waits_ = true;                                         // for locks of other programs
  std::chrono::steady_clock::time_point wait_end_;
  std::chrono::steady_clock::time_point written_ = std::chrono::steady_clock::now();
  std::vector<Change> changes_;
  std::vector<std::pair<TrialKey, TrialOutcome>> trials_;  // to be written
  std::set<std::int64_t> damaged_rows_;                    // to be removed
  int damaged_ = 0;
  int added_ = 0;
};

}  // namespace gauntlet::sim
