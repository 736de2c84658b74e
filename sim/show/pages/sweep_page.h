#pragma once

#include <string>

#include "sim/answers/sweep/response.h"
#include "sim/answers/sweep/sweep_result.h"

namespace gauntlet::sim {

/// Page of `gauntlet sweep`.
std::string SweepPage(const SweepPlan& plan, SweepDatabase& database, const CellRange& cells,
                      const SweepSummary& summary, const Response& response);

}  // namespace gauntlet::sim
