#pragma once

#include <string>

#include "sim/inspect/inspection.h"
#include "sim/results/result_table.h"

namespace gauntlet::sim {

/// A row per column of the file: what it is taken for and why, and what its numbers are like.
ResultTable ColumnsTable(const Inspection& inspection);
std::string InspectionJson(const Inspection& inspection);

/// "tab", "comma", ...
std::string SeparatorText(char separator);

}  // namespace gauntlet::sim
