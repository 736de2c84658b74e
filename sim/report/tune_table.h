#pragma once

#include <string>

#include "sim/report/table_text.h"
#include "sim/study/tune.h"

namespace gauntlet::sim {

/// What tuning found, for a person at a terminal: values, scores on the held-out seeds, the front.
std::string TuneTable(const TunePlan& plan, const TuneResult& result, const TerminalStyle& style);

/// `seeds 1 to 8`.
std::string SeedsText(int first, int count);

}  // namespace gauntlet::sim
