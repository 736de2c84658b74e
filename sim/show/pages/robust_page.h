#pragma once

#include <string>

#include "sim/answers/robust/robust.h"

namespace gauntlet::sim {

/// Page of `gauntlet robust`, with a tornado for each score. The command that repeats a hand begins
/// with the scenario as it was resolved, which lies beside the page.
std::string RobustPage(const RobustPlan& plan, SweepDatabase& database, const RobustResult& result);

}  // namespace gauntlet::sim
