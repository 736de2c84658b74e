#pragma once

#include <functional>
#include <string>
#include <vector>

#include "sim/answers/sweep/sweep_run.h"
#include "sim/score/statistics/judgement.h"
#include "sim/study/trial_table/sweep_database.h"

namespace gauntlet::sim {

/// Does a score keep a bound?
enum class Met {
  kYes,     // with its whole 95 % interval
  kLikely,  // its mean does, not its whole interval
  kUnlikely,
  kNo,  // not any of its interval
  kUnscored,
};
std::string_view MetText(Met met);  // "yes", "likely", ...
Met IsMet(const Constraint& constraint, const MeanInterval& score);

/// One controller of one cell over all its seeds.
struct CellResult {
  std::int64_t number = 0;
  std::string controller;
  std::vector<std::string> values;           // of the axes
  std::vector<MeanInterval> scores;          // of the plan's metrics, 95 %
  std::vector<std::vector<double>> by_seed;  // of the plan's metrics
  std::vector<int> motions;                  // of the seeds
  Met met = Met::kYes;                       // the worst of all constraints
  int failed_trials = 0;                     // their hands were stopped: it cannot be the best
  std::string problem;                       // why it could not be built, or the first trial failed

  bool CanBeBest() const { return problem.empty() && (met == Met::kYes || met == Met::kLikely); }
};

/// The result of a sweep without the cells themselves.
struct SweepSummary {
  std::vector<CellResult> best;  // up to ten that keep all constraints, the best first
  std::vector<CellResult> near;  // none does: up to three that are nearest in best_by
  std::int64_t results = 0;      // controllers of cells with scores
  std::int64_t meeting = 0;      // of these, that keep all constraints (yes or likely)
  std::int64_t not_built = 0;    // cells
  std::int64_t failed = 0;       // controllers of cells, whose trials failed
  std::int64_t missing = 0;      // cells that the database does not hold: another shard's
  std::string first_problem;     // of those not built or failed
};

/// The place of a score in `metrics`; their number if it is not among them.
std::size_t PlaceOfMetric(const std::vector<std::size_t>& metrics, std::size_t metric);

/// Reads the cells in order, one at a time.
void ForEachCell(const SweepPlan& plan, SweepDatabase& database, const CellRange& cells,
                 const std::function<void(const CellResult&)>& see);

/// One pass over all cells; `see` may be empty.
SweepSummary SummariseSweep(const SweepPlan& plan, SweepDatabase& database, const CellRange& cells,
                            const std::function<void(const CellResult&)>& see = {});

/// Number of pairs of so many settings.
constexpr double PairsOf(double count) { return 0.5 * count * (count - 1.0); }

/// Difference of one score between two settings, paired by seed, as one of so many pairs: see
/// judgement.h.
Comparison ComparePaired(std::size_t metric, std::span<const double> first,
                         std::span<const double> second, std::span<const int> motions,
                         double pairs);
/// In the score that decides, over the seeds that both have.
Comparison CompareCells(const SweepPlan& plan, const CellResult& first, const CellResult& second,
                        double pairs);

}  // namespace gauntlet::sim
