#pragma once

#include <span>
#include <string>
#include <string_view>

#include "sim/study/summary.h"

namespace gauntlet::sim {

struct TableOptions {
  bool comparison = false;  // means with intervals, else the values of one seed
  bool colour = false;      // mark best and worse-than-raw with terminal colours besides signs
};

/// The keys of the scores of the main question: the columns of the table, besides
/// `grip_force_ripple_n` where something was held. All others are in scores.json and on the report
/// page.
std::span<const std::string_view> MainMetrics();

/// What the numbers say, in one sentence; empty where tracking or jitter has no value.
std::string Verdict(const Summary& summary);

/// The scores for a person at a terminal: what was asked, one row per controller, a star at the
/// best of each column and at those no worse beyond chance, an exclamation mark where a filter is
/// worse than none, and a verdict.
std::string ScoreTable(const Study& study, const StudyResult& result, const Summary& summary,
                       const TableOptions& options);

}  // namespace gauntlet::sim
