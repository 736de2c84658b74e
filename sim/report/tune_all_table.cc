#include "sim/report/tune_all_table.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "sim/report/table_text.h"
#include "sim/report/tune_table.h"
#include "sim/scenario/scenario_reader.h"

namespace gauntlet::sim {

std::string TuneAllVerdict(const TunePlan& plan, const std::vector<TunedKind>& kinds) {
  if (!kinds.front().has_answer()) return "No kind of filter keeps the bounds.";
  std::vector<std::string> equal;
  for (const TunedKind& tuned : kinds) {
    if (tuned.to_best.judgement == Judgement::kEqual && &tuned != &kinds.front()) {
      equal.push_back(tuned.kind);
    }
  }
  const Metric& metric = Metrics()[plan.minimise];
  std::string text = fmt::format("{} has the {} {}", kinds.front().kind,
                                 metric.lower_is_better ? "least" : "most", metric.key);
  if (!equal.empty()) {
    text += fmt::format("; equal to it within what matters: {}", fmt::join(equal, ", "));
  }
  return text + ".";
}

std::string TuneAllTable(const TunePlan& plan, const std::vector<TunedKind>& kinds,
                         const TerminalStyle& style) {
  const Metric& metric = Metrics()[plan.minimise];
  std::string text = fmt::format("{} of {}{}, each kind of filter as its filter: {} {}",
                                 plan.controller, plan.scenario.file.stem().string(),
                                 plan.physics ? "" : " (filters only, no hand)",
                                 metric.lower_is_better ? "least" : "most", metric.key);
  for (const Constraint& constraint : plan.constraints) text += ", " + constraint.Text();
  const int first_seed = ParseScenario(plan.scenario).seed;
  text += fmt::format(
      "\nat most {} settings of each tried on {}; judged on {}, which no search has seen\n\n",
      plan.evaluations, SeedsText(first_seed, plan.seeds),
      SeedsText(first_seed + plan.seeds, plan.held_out));
  std::vector<std::vector<std::string>> rows = {{"filter"}};
  for (const std::size_t m : kinds.front().result.metrics) {
    rows[0].emplace_back(Metrics()[m].key);
  }
  rows[0].insert(rows[0].end(), {"to the best", "settings"});
  std::string others;
  for (const TunedKind& tuned : kinds) {
    if (!tuned.has_answer()) {
      others += fmt::format("{}: {}\n", tuned.kind,
                            tuned.left_out.empty() ? tuned.result.problem : tuned.left_out);
      continue;
    }
    std::vector<std::string>& row = rows.emplace_back();
    row.push_back(tuned.kind);
    for (const MeanInterval& score : tuned.result.verdict.scores) {
      row.push_back(IntervalText(score));
    }
    row.emplace_back(&tuned == &kinds.front() ? "best" : JudgementText(tuned.to_best.judgement));
    row.push_back(SettingsText(tuned.plan, tuned.result.verdict.values));
  }
  if (rows.size() > 1) text += AlignedTable(rows, style) + "\n";
  return text + others + Wrapped(TuneAllVerdict(plan, kinds), style.width) + "\n";
}

}  // namespace gauntlet::sim
