#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "sim/study/study_identity.h"
#include "sim/study/study_run.h"

namespace gauntlet::sim {

/// One controller in one cell, or the reason why there is no such cell.
struct SweepCellRecord {
  std::int64_t number = 0;
  std::string controller;
  std::string study;
  std::string settings;
  std::vector<int> motions;  // per seed: see SeedOutcome
  std::string problem;
};

/// The finished trials and the cells of a sweep in `study.db`; its tables are those of comparisons
/// (study_schema.h). Of a trial it keeps the means of the scores that the sweep asks for, some
/// hundred bytes. Nothing is read before it is asked for, so memory does not grow with the file.
///
/// Trials are written together, a few times per second: a program that is killed computes a quarter
/// of a second again. See TrialTable for locks, damage and full disks.
///
/// Any thread may call it. Errors: as of TrialTable.
class SweepDatabase {
 public:
  /// `sweep`: hash of all that decides which cells there are. `metrics`: that are kept.
  SweepDatabase(std::filesystem::path file, std::string sweep, std::vector<std::size_t> metrics);
  ~SweepDatabase();

  /// The trial of `first` and those of the seeds after it, with the means of the kept scores.
  std::vector<std::optional<TrialOutcome>> Read(const TrialKey& first, int seeds = 1);
  /// See TrialTable.
  void ReadTogether(const std::function<void()>& work);
  /// Errors: RunError when the disk is full.
  void Keep(const TrialKey& key, const TrialOutcome& outcome);
  /// `scenario`: the settings that the trials of `study` share, as YAML.
  void AddStudy(const std::string& study, const std::string& scenario);
  /// `values`: key and value of each axis.
  void AddCell(const SweepCellRecord& cell,
               const std::vector<std::pair<std::string, std::string>>& values);
  /// The controllers of one cell, sorted by name.
  std::vector<SweepCellRecord> CellAt(std::int64_t number);
  /// Writes what waits, and waits for other programs. Errors: RunError where the file does not take
  /// it.
  void Flush();
  /// Takes over what another file of the same sweep or of others holds, and this one does not.
  /// Again changes nothing. Errors: UserError for a file that is not such a database, or a link;
  /// RunError.
  void Collect(const std::filesystem::path& other);

  /// Trials in the file.
  std::int64_t TrialCount();
  /// Trials that were asked for and whose checksum did not match.
  int DamagedCount() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace gauntlet::sim
