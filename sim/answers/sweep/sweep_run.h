#pragma once

#include <functional>
#include <string>

#include "sim/answers/sweep/sweep_plan.h"
#include "sim/study/elsewhere.h"
#include "sim/study/trial_table/sweep_database.h"

namespace gauntlet::sim {

/// The work of a sweep, estimated before it starts.
struct SweepForecast {
  double trials = 0.0;  // that are still to be run, twins counted
  double seconds = 0.0;
};

struct SweepOptions {
  int jobs = 1;
  CellRange cells;
  /// Called once, before the second trial is run; not at all where all are known.
  std::function<void(const SweepForecast&)> forecast = {};
  /// Gets trials done and trials in all, twins counted; false stops: Cancelled.
  std::function<bool(double, double)> progress = {};
  std::function<void(const std::string&)> remark = {};  // see StudyOptions
  /// Computes the cells that the database lacks; null: this process does.
  Elsewhere* elsewhere = nullptr;
};

/// Hash of all that decides which cells a sweep has and what they do: the study file as read, the
/// base scenario with its recordings and its hand, files that axes name, and the program. Builds
/// the base scenario. Errors: UserError, SettingError where it cannot be built.
std::string HashOfSweep(const SweepPlan& plan);

/// Runs what the database lacks of these cells. One that cannot be built is kept with its reason.
/// Cells that differ in controllers alone share glove, hand and one call of RunStudy().
/// The final content of the database does not depend on jobs, order or interruptions.
void RunSweep(const SweepPlan& plan, SweepDatabase& database, const SweepOptions& options);

}  // namespace gauntlet::sim
