#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "sim/report/table_text.h"
#include "sim/study/response.h"
#include "sim/study/sweep_result.h"

namespace gauntlet::sim {

/// The best cells of a sweep for a person at a terminal, what became of the others, and the command
/// that repeats the best as a comparison.
std::string SweepTable(const SweepPlan& plan, const SweepSummary& summary, const Response& response,
                       const TerminalStyle& style);

/// "prediction is better than raw at frequency_hz 0.5 to 2.5, worse at 4", a line per controller;
/// nothing of a sweep that has no such curve, or one controller.
std::string ResponseText(const SweepPlan& plan, const Response& response);

/// The last part of an axis' key that still tells the axes apart, and is not a score's.
std::string ShortKey(const SweepPlan& plan, std::size_t axis);

/// A file's name in the folder where the program runs.
std::string NameHere(const std::filesystem::path& file);

/// The command that repeats a setting as a comparison; of no `controller` with all of them. Of the
/// scenario its NameHere(), which takes longer to find than all the rest.
std::string CompareCommand(const std::string& scenario, int seeds, const std::string& controller,
                           const std::vector<std::string>& sets);
std::string RepeatCommand(const SweepPlan& plan, const std::string& scenario,
                          const std::string& controller, std::int64_t cell);

}  // namespace gauntlet::sim
