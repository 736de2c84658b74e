#pragma once

#include <string>
#include <vector>

#include "sim/sweep/sweep_result.h"

namespace gauntlet::sim {

/// What a controller is against the first one at each value of the setting.
struct ResponseVerdict {
  std::string controller;
  std::vector<Judgement> judgements;  // one per value
};

/// How scores follow the one setting that a sweep varies, a curve for each controller: "up to which
/// frequency does prediction help?" is a question about a curve, not about the best cell.
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

/// Of a sweep over one setting that is a number in every cell, of at most 100 values and 8
/// controllers; empty (no values) of any other.
Response ReadResponse(const SweepPlan& plan, SweepDatabase& database, const CellRange& cells);

}  // namespace gauntlet::sim
