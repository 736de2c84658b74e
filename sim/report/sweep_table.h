#pragma once

#include <string>

#include "sim/study/sweep_result.h"

namespace gauntlet::sim {

/// The best cells of a sweep for a person at a terminal, what became of the others, and the command
/// that repeats the best as a comparison.
std::string SweepTable(const SweepPlan& plan, const SweepSummary& summary);

}  // namespace gauntlet::sim
