#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "sim/study/robust.h"
#include "sim/study/summary.h"
#include "sim/study/tune_all.h"

namespace gauntlet::sim {

/// A sentence of a verdict. `key`: what it is about, for programs.
struct VerdictRemark {
  std::string key;
  std::string text;
};

/// What to use, and why. It is made once, from the judgements: terminal, page and JSON show it.
struct Verdict {
  std::string recommended = {};  // a controller, cell, setting or filter; may be empty
  std::vector<std::string> alternatives = {};  // equal within what matters, or better elsewhere
  std::vector<VerdictRemark> reasons = {};
  std::vector<VerdictRemark> warnings = {};

  /// All reasons and warnings; empty where nothing can be said.
  std::string Text() const;
};

/// {"version": 1, "recommended": .., "alternatives": [..], "reasons": [{"key", "text"}],
/// "warnings": [{"key", "text"}]}.
nlohmann::ordered_json JsonOf(const Verdict& verdict);

/// Of controllers: who follows best and, of those that follow as well, shakes least; beside it who
/// shakes least of all. Nobody is recommended where it is undecided who follows best, after one run
/// alone, and where tracking or jitter has no value.
Verdict VerdictOf(const Summary& summary);
/// The best cell by the score that decides; nothing is recommended where others are undecided
/// against it. The same of filters, below.
Verdict VerdictOf(const SweepPlan& plan, const SweepSummary& summary);
/// The setting that was found.
Verdict VerdictOf(const TunePlan& plan, const TuneResult& result);
/// The filter that is best on seeds that no search has seen.
Verdict VerdictOf(const TunePlan& plan, const std::vector<TunedKind>& kinds);
/// Who is best on the scenario's own hand, a reason per score; recommended by the one that decides.
Verdict VerdictOf(const RobustPlan& plan, const RobustResult& result);

/// The controllers in the order of the verdict: who follows best, who shakes least, the others by
/// how they follow.
std::vector<std::size_t> OrderOfVerdict(const Summary& summary);

/// The main metrics that some controller has a value of.
std::vector<std::size_t> ShownMetrics(const Summary& summary);

}  // namespace gauntlet::sim
