#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "sim/study/study.h"

namespace gauntlet::sim {

/// "warning: .." if a resolved scenario comes from another model of the hand than `hand`, with what
/// that may change; else empty.
std::string MadeElsewhere(const MadeWith& made, const HandModel& hand,
                          std::string_view consequence);

/// All that a user should know before the trials, a line each: a scenario that was resolved with
/// another hand, on a machine that computes other last bits, or with other files; then the remarks
/// of the study.
std::vector<std::string> WarningsOf(const Study& study);

}  // namespace gauntlet::sim
