#pragma once

#include <cstddef>
#include <vector>

#include "sim/comparison/summary.h"
#include "sim/results/verdict.h"

namespace gauntlet::sim {

/// The verdict of a comparison. It recommends the controller with the least jitter among those that
/// track best, and names the one with the least jitter of all. It recommends nobody if the best
/// tracking is undecided, after a single run, and if tracking or jitter has no value.
Verdict VerdictOf(const Summary& summary);
/// The controllers in the order of the verdict: who follows best, who shakes least, the others by
/// how they follow.
std::vector<std::size_t> OrderOfVerdict(const Summary& summary);

/// The main metrics that some controller has a value of.
std::vector<std::size_t> ShownMetrics(const Summary& summary);

}  // namespace gauntlet::sim
