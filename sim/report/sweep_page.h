#pragma once

#include <string>

#include "sim/study/response.h"
#include "sim/study/sweep_result.h"

namespace gauntlet::sim {

/// Page of `gauntlet sweep`.
std::string SweepPage(const SweepPlan& plan, SweepDatabase& database, const CellRange& cells,
                      const SweepSummary& summary, const Response& response);

}  // namespace gauntlet::sim
