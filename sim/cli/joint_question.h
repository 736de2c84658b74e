#pragma once

#include <string>

#include "sim/recordings/inspect/inspection.h"

namespace gauntlet::sim {

/// True if a person can be asked: standard input and standard error are terminals.
bool CanAsk();

/// Asks at the terminal for the joints of ColumnsToName(), or for a profile. After a wrong answer
/// it asks again. Returns the column map of the answer; empty if the question was left open.
/// `options`: those of the inspection.
std::string AskForMap(const Inspection& inspection, const InspectionOptions& options);

}  // namespace gauntlet::sim
