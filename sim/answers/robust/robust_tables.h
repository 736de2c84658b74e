#pragma once

#include <string>

#include "sim/answers/robust/robust.h"
#include "sim/results/table_text.h"
#include "sim/results/verdict.h"

namespace gauntlet::sim {

/// "effect", "no effect", "undecided"; empty where there is nothing to judge.
std::string_view TornadoVerdict(const TornadoBar& bar);

/// The controller that the verdict is about: the recommended one, else the best on the nominal
/// hand.
std::string JudgedController(const RobustPlan& plan, const RobustResult& result);

/// "75 to 99 %": the confidence interval of a share.
std::string PercentText(const Share& share);

/// The best controller on the nominal hand, with a reason for each score. It recommends the
/// best by the score that decides, if none is undecided against it.
Verdict VerdictOf(const RobustPlan& plan, const RobustResult& result);

/// `robust.csv` and `tornado.csv`: the rows of all scores.
std::string RobustCsv(const RobustResult& result);
std::string TornadoCsv(const RobustPlan& plan, const RobustResult& result);
std::string RobustJson(const RobustPlan& plan, const RobustResult& result);

/// The result for people: for each score the verdict on the nominal hand and the share of
/// hands on which each controller is best, then the parameters that matter for the score that
/// decides, and a sentence for each score.
ResultText RobustText(const RobustPlan& plan, const RobustResult& result, bool verbose);

}  // namespace gauntlet::sim
