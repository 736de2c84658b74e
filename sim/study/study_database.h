#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "sim/study/study.h"

namespace gauntlet::sim {

/// The finished trials of a comparison in `study.db`, an SQLite database that any tool opens: a row
/// per trial and score. A comparison that was stopped, even killed, goes on from it.
///
///     SELECT controller, avg(value) FROM scores
///     WHERE metric = 'tracking_rmse_deg' AND channel = 'summary' GROUP BY controller;
///
/// A trial belongs to all that decides it: glove, hand, event, the model, the glove signal of the
/// first seed and the program itself (a row of `study`), then the controller's settings and the
/// seed. Trials of other studies stay where they are: changing a setting and changing it back costs
/// nothing. The view `scores` shows what was asked for last, `all_scores` every one. The
/// file appears with the first trial.
///
/// Any thread may call Find and Keep. Errors: UserError for a file that is not such a database,
/// RunError when the disk does not take a trial.
class StudyDatabase {
 public:
  /// `study` has to outlive the database.
  StudyDatabase(std::filesystem::path file, const Study& study);
  ~StudyDatabase();

  std::optional<TrialOutcome> Find(int seed, std::size_t controller);
  void Keep(int seed, std::size_t controller, const TrialOutcome& outcome);

  /// Trials of this study that the file holds.
  int TrialCount();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace gauntlet::sim
