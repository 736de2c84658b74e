#pragma once

#include <string>

#include "sim/answers/tune/tune.h"

namespace gauntlet::sim {

/// Page of `gauntlet tune`: a point is a setting that was tried.
std::string TunePage(const TunePlan& plan, const TuneResult& result);

}  // namespace gauntlet::sim
