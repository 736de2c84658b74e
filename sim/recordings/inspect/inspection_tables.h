#pragma once

#include <string>
#include <vector>

#include "sim/recordings/inspect/inspection.h"
#include "sim/results/result_table.h"

namespace gauntlet::sim {

/// A row per column of the file: its quantity or joint, and statistics of its values. People see
/// the reasons if `is_verbose`.
ResultTable ColumnsTable(const Inspection& inspection, bool is_verbose);
/// A row per topic of a file of messages.
ResultTable TopicsTable(const std::vector<ListedTopic>& topics);
/// Lines about sensors with a defect, the worst first.
std::string HealthText(const Inspection& inspection);
/// "noise 3 to 4.2 counts, 0.48 to 0.8 deg of the joints"; empty without joints or noise.
std::string NoiseText(const Inspection& inspection);
/// The answer in one line: "5 sensors, 60 Hz, counts: 2 dead (index_pip, little_pip)".
std::string SummaryOf(const Inspection& inspection);
/// Evidence for the joints: "by name", "by order, assumed", ..
std::string BasisText(const Inspection& inspection);
std::string InspectionJson(const Inspection& inspection);

/// "tab", "comma", ...
std::string SeparatorText(char separator);

}  // namespace gauntlet::sim
