#pragma once

#include <chrono>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "sim/study/study_identity.h"
#include "sim/study/study_run.h"

namespace gauntlet::sim {

/// Options of the database of a comparison.
struct StudyDatabaseOptions {
  int seeds = 1;  // the scenario's seed and those after it: what may be asked for
  /// Longest wait for other programs that hold the file, when it is opened and at the end.
  std::chrono::milliseconds patience{10'000};
};

/// The finished trials of a comparison in `study.db`, an SQLite database that any tool opens: a row
/// per trial and score. A comparison that was stopped, even killed, goes on from it.
///
///     SELECT controller, avg(value) FROM scores
///     WHERE metric = 'tracking_rmse_deg' AND channel = 'summary' GROUP BY controller;
///
/// A trial belongs to all that decides it: glove, hand, event, the model, the glove signals of the
/// first seed of every repetition and the program itself (a row of `study`), then the controller's
/// settings and the seed. Trials of other studies stay where they are: changing a setting and
/// changing it back costs nothing. The view `scores` shows what was asked for last, `all_scores`
/// every one.
///
/// Opening reads all that may be asked for, and nothing later: a file that is damaged, locked or
/// cannot be written is found before the first trial is run. From then on the results are in
/// memory, and the file only has to take them, trial by trial. See TrialTable for locks, damage and
/// full disks.
///
/// Any thread may call Has, Take and Keep. Errors: as of TrialTable.
class StudyDatabase final : public TrialStore {
 public:
  /// `study` has to outlive the database.
  StudyDatabase(std::filesystem::path file, const Study& study, StudyDatabaseOptions options = {});
  /// For many files of one study, whose identity is known.
  StudyDatabase(std::filesystem::path file, const Study& study, StudyIdentity identity,
                StudyDatabaseOptions options);
  ~StudyDatabase() override;

  /// True for a trial that the file held when it was opened, until it is taken.
  bool Has(int seed, std::size_t controller) override;
  std::optional<TrialOutcome> Take(int seed, std::size_t controller) override;
  /// Does not wait for other programs. Errors: RunError when the disk is full.
  void Keep(int seed, std::size_t controller, const TrialOutcome& outcome) override;
  /// See TrialTable::Finish().
  std::optional<std::string> Finish();

  /// Trials of this study that the file holds, damaged ones not counted.
  int TrialCount() const;
  /// Trials that were asked for and whose checksum did not match.
  int DamagedCount() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace gauntlet::sim
