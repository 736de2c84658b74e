#include "sim/report/tune_table.h"

#include <fmt/format.h>

#include <algorithm>

#include "sim/scenario/scenario_reader.h"

namespace gauntlet::sim {
namespace {

constexpr std::size_t kMostOfFront = 12;

/// A key without the controllers.<name>. before it.
std::string KeyInController(const TunePlan& plan, std::size_t axis) {
  return plan.free[axis].key.substr(std::string("controllers.").size() + plan.controller.size() +
                                    1);
}

std::string FrontTable(const TunePlan& plan, const TuneResult& result, const TerminalStyle& style) {
  std::vector<std::vector<std::string>> rows(1);
  const std::size_t delay = MetricIndex("delay_ms");
  const std::size_t jitter = MetricIndex("jitter_rms_deg");
  for (std::size_t a = 0; a < plan.free.size(); ++a) rows[0].push_back(KeyInController(plan, a));
  for (const std::size_t metric : {delay, jitter}) rows[0].emplace_back(Metrics()[metric].key);
  const std::size_t last = result.front.size() - 1;
  const std::size_t shown = std::min(result.front.size(), kMostOfFront);
  for (std::size_t i = 0; i < shown; ++i) {
    const std::size_t at = shown == 1 ? 0 : (i * last + (shown - 1) / 2) / (shown - 1);
    const TunedSetting& setting = result.tried[result.front[at]];
    std::vector<std::string>& row = rows.emplace_back(setting.values);
    for (const std::size_t metric : {delay, jitter}) {
      row.push_back(IntervalText(setting.scores[PlaceOfMetric(result, metric)]));
    }
  }
  return AlignedTable(rows, style);
}

}  // namespace

std::string SeedsText(int first, int count) {
  return count == 1 ? fmt::format("seed {}", first)
                    : fmt::format("seeds {} to {}", first, first + count - 1);
}

std::string TuneTable(const TunePlan& plan, const TuneResult& result, const TerminalStyle& style) {
  const int first_seed = ParseScenario(plan.scenario).seed;
  const Metric& metric = Metrics()[plan.minimise];
  std::string text =
      fmt::format("{} of {}{}: {} {}", plan.controller, plan.scenario.file.stem().string(),
                  plan.physics ? "" : " (filters only, no hand)",
                  metric.lower_is_better ? "least" : "most", metric.key);
  for (const Constraint& constraint : plan.constraints) text += ", " + constraint.Text();
  text += fmt::format("\n{} settings tried on {}; judged on {}, which the search has not seen\n\n",
                      result.tried.size(), SeedsText(first_seed, plan.seeds),
                      SeedsText(first_seed + plan.seeds, plan.held_out));
  std::vector<std::vector<std::string>> rows = {
      {"setting", "tuned", "as good within what matters"}};
  for (std::size_t a = 0; a < plan.free.size(); ++a) {
    rows.push_back({KeyInController(plan, a), result.tried[result.chosen].values[a],
                    fmt::format("{} to {}", result.equal[a].low, result.equal[a].high)});
  }
  text += AlignedTable(rows, style) + "\n";
  rows = {{"held-out seeds", "before", "tuned"}};
  for (std::size_t m = 0; m < result.metrics.size(); ++m) {
    rows.push_back({std::string(Metrics()[result.metrics[m]].key),
                    IntervalText(result.before.scores[m]), IntervalText(result.verdict.scores[m])});
  }
  if (!plan.constraints.empty()) {
    rows.push_back({"constraints", std::string(MetText(result.before.met)),
                    std::string(MetText(result.verdict.met))});
  }
  text += AlignedTable(rows, style);
  if (result.before.problem.empty()) {
    const std::string_view judgement = JudgementText(result.gain.judgement);
    text += fmt::format("tuned - before, paired by seed: {} {} (95 %): {}\n",
                        IntervalText(result.gain.difference), metric.key,
                        judgement.empty() ? "one seed decides nothing" : judgement);
  }
  if (result.refused > 0) {
    text +=
        fmt::format("{} better on the first seeds broke a bound on the others.\n", result.refused);
  }
  if (!result.front.empty()) {
    text += "\nno setting that was tried has less delay and less jitter:\n" +
            FrontTable(plan, result, style);
  }
  return text;
}

}  // namespace gauntlet::sim
