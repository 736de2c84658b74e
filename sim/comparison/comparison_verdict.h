#pragma once

#include <cstddef>
#include <vector>

#include "sim/comparison/summary.h"
#include "sim/results/verdict.h"

namespace gauntlet::sim {

/// Of controllers: who follows best and, of those that follow as well, shakes least; beside it who
/// shakes least of all. Nobody is recommended where it is undecided who follows best, after one run
/// alone, and where tracking or jitter has no value.
Verdict VerdictOf(const Summary& summary);
/// The controllers in the order of the verdict: who follows best, who shakes least, the others by
/// how they follow.
std::vector<std::size_t> OrderOfVerdict(const Summary& summary);

/// The main metrics that some controller has a value of.
std::vector<std::size_t> ShownMetrics(const Summary& summary);

}  // namespace gauntlet::sim
