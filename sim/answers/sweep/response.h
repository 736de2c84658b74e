#pragma once

#include <string>
#include <vector>

#include "sim/answers/sweep/sweep_result.h"

namespace gauntlet::sim {

/// Judgement of a controller against the first one at each value of the setting.
struct ResponseVerdict {
  std::string controller;
  std::vector<Judgement> judgements;  // one per value
};

/// Scores as a function of the one setting that a sweep varies, one curve for each controller. "Up
/// to which frequency does prediction help?" asks for a curve, not for the best cell.
struct Response {
  std::vector<double> values;            // of the setting, ascending
  std::vector<std::string> texts;        // the same as written
  std::vector<std::string> controllers;  // in the order of the scenario
  std::vector<std::size_t> metrics;      // of Metrics(), that were kept
  /// By value, by controller, by metric; without a number where a cell could not be built.
  std::vector<std::vector<std::vector<MeanInterval>>> scores;
  /// In the score that decides, all controllers but the first against it: one family.
  std::vector<ResponseVerdict> verdicts;
  std::size_t comparisons = 0;  // of the family
};

/// Reads a sweep over one setting that is a number in every cell, with at most 100 values and 8
/// controllers. Empty (no values) for other sweeps.
Response ReadResponse(const SweepPlan& plan, SweepDatabase& database, const CellRange& cells);

}  // namespace gauntlet::sim
