#pragma once

#include <string>
#include <vector>

#include "sim/report/table_text.h"
#include "sim/study/tune_all.h"

namespace gauntlet::sim {

/// What `tune --all` found, for a person at a terminal: a row per kind of filter, the best first.
std::string TuneAllTable(const TunePlan& plan, const std::vector<TunedKind>& kinds,
                         const TerminalStyle& style);

/// `kalman has the least delay_ms (jitter_rms_deg<=0.2), equal to it within what matters: ..`
std::string TuneAllVerdict(const TunePlan& plan, const std::vector<TunedKind>& kinds);

}  // namespace gauntlet::sim
