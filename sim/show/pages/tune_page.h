#pragma once

#include <string>
#include <vector>

#include "sim/answers/tune/tune_all.h"

namespace gauntlet::sim {

/// Page of `gauntlet tune`: a point is a setting that was tried.
std::string TunePage(const TunePlan& plan, const TuneResult& result);

/// Page of `gauntlet tune --all`: the fronts of all kinds of filters in one picture. A point is a
/// setting that was tried.
std::string TuneAllPage(const TunePlan& plan, const std::vector<TunedKind>& kinds);

}  // namespace gauntlet::sim
