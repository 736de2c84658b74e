#pragma once

#include <string>

#include "sim/report/table_text.h"
#include "sim/study/robust.h"

namespace gauntlet::sim {

/// Whether the verdicts hold on other hands, for a person at a terminal: per score the verdict on
/// the scenario's own hand and the share of hands on which each controller is best, then what
/// matters in the score that decides, and in the end a sentence per score.
std::string RobustTable(const RobustPlan& plan, const RobustResult& result,
                        const TerminalStyle& style);

/// One sentence per score: who is best on the scenario's own hand, and on how many of the others.
std::vector<std::string> RobustVerdicts(const RobustResult& result);

/// What the hands are: "32 hands, each with friction, delay ... within 30 % of the scenario's".
std::string HandsText(const RobustPlan& plan);

}  // namespace gauntlet::sim
