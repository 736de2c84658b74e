#pragma once

#include <string>

#include "sim/study/robust.h"

namespace gauntlet::sim {

/// Page of `gauntlet robust`, with a tornado for each score.
std::string RobustPage(const RobustPlan& plan, SweepDatabase& database, const RobustResult& result,
                       const std::string& table);

}  // namespace gauntlet::sim
