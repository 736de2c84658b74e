#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "sim/answers/sweep/response.h"
#include "sim/answers/sweep/sweep_result.h"
#include "sim/results/result_table.h"
#include "sim/results/table_text.h"
#include "sim/results/verdict.h"

namespace gauntlet::sim {

/// The last part of an axis' key that still tells the axes apart, and is not a score's.
std::string ShortKey(const SweepPlan& plan, std::size_t axis);

/// The best cells, or the nearest where none keeps the constraints, each compared with the first.
ResultTable BestCells(const SweepPlan& plan, const SweepSummary& summary);

/// The best cell by the score that decides; nothing is recommended where others are undecided
/// against it.
Verdict VerdictOf(const SweepPlan& plan, const SweepSummary& summary);

/// SummariseSweep(), and the text of cells.csv piece by piece.
SweepSummary WriteCellsCsv(const SweepPlan& plan, SweepDatabase& database, const CellRange& cells,
                           const std::function<void(std::string_view)>& write);
/// The whole sweep as JSON, piece by piece. `summary`: of all cells.
void WriteSweepJson(const SweepPlan& plan, SweepDatabase& database, const CellRange& cells,
                    const SweepSummary& summary,
                    const std::function<void(std::string_view)>& write);

/// The best cells of a sweep for a person, what became of the others, and the command that repeats
/// the best as a comparison.
ResultText SweepText(const SweepPlan& plan, const SweepSummary& summary, const Response& response,
                     bool verbose);

/// "prediction is better than raw at frequency_hz 0.5 to 2.5, worse at 4", a line per controller;
/// nothing of a sweep that has no such curve, or one controller.
std::string ResponseText(const SweepPlan& plan, const Response& response);

/// A file's name in the folder where the program runs.
std::string NameHere(const std::filesystem::path& file);

/// The command that repeats a setting as a comparison; of no `controller` with all of them. Of the
/// scenario its NameHere(), which takes longer to find than all the rest.
std::string CompareCommand(const std::string& scenario, int seeds, const std::string& controller,
                           const std::vector<std::string>& sets);
std::string RepeatCommand(const SweepPlan& plan, const std::string& scenario,
                          const std::string& controller, std::int64_t cell);

}  // namespace gauntlet::sim
