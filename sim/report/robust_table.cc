#include "sim/report/robust_table.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

namespace gauntlet::sim {
namespace {

std::string ShareText(const Share& share) {
  return fmt::format("{} of {} ({:.0f} to {:.0f} %)", share.hits, share.count,
                     std::floor(100.0 * share.low), std::ceil(100.0 * share.high));
}

std::string ScoreTableOf(const RobustResult& result, const RobustScore& score,
                         const TerminalStyle& style) {
  std::vector<std::vector<std::string>> rows = {
      {std::string(Metrics()[score.metric].key), "own hand", "verdict", "best", "as good"}};
  for (std::size_t c = 0; c < score.controllers.size(); ++c) {
    const ControllerSummary& nominal = result.nominal.controllers[c];
    const bool best = score.two_best.front() == c;
    const std::string_view verdict = JudgementText(nominal.to_best[score.metric].judgement);
    rows.push_back({nominal.name, IntervalText(nominal.summary[score.metric]),
                    std::string(best ? "best" : verdict), ShareText(score.controllers[c].best),
                    ShareText(score.controllers[c].near_best)});
  }
  return AlignedTable(rows, style);
}

std::string TornadoRows(const RobustPlan& plan, const RobustScore& score,
                        const TerminalStyle& style) {
  if (score.bars.empty()) return "";
  std::vector<std::vector<std::string>> rows = {{"parameter", "low", "high", "high - low", ""}};
  for (const TornadoBar& bar : score.bars) {
    std::vector<std::string>& row = rows.emplace_back();
    row.push_back(plan.parameters[bar.parameter].name);
    if (bar.problem.empty()) {
      row.insert(row.end(),
                 {IntervalText(bar.low), IntervalText(bar.high),
                  IntervalText(bar.change.difference), std::string(TornadoVerdict(bar))});
    } else {
      row.insert(row.end(), {"-", "-", "-", bar.problem});
    }
  }
  return fmt::format("What matters: {} - {} in {}, one parameter at a time\n{}\n",
                     score.controllers[score.two_best[0]].name,
                     score.controllers[score.two_best[1]].name, Metrics()[score.metric].key,
                     AlignedTable(rows, style));
}

}  // namespace

std::string HandsText(const RobustPlan& plan) {
  std::vector<std::string> names;
  for (const RobustParameter& parameter : plan.parameters) names.push_back(parameter.name);
  std::string text = fmt::format("{} hands, each with {} within {:g} % of the scenario's",
                                 plan.hands, fmt::join(names, ", "), plan.within_percent);
  if (!plan.not_varied.empty()) {
    text += fmt::format(" (not {}, which {} 0 there)", fmt::join(plan.not_varied, ", "),
                        plan.not_varied.size() == 1 ? "is" : "are");
  }
  return text + fmt::format("; {} seed{} each", plan.sweep.file.seeds,
                            plan.sweep.file.seeds == 1 ? "" : "s");
}

std::vector<std::string> RobustVerdicts(const RobustResult& result) {
  std::vector<std::string> verdicts;
  for (const RobustScore& score : result.scores) {
    const RobustController& best = score.controllers[score.two_best.front()];
    verdicts.push_back(fmt::format(
        "{}: {} is best on the scenario's own hand, and as good as the best on {} of {} hands "
        "({:.0f} "
        "to {:.0f} %).",
        Metrics()[score.metric].key, best.name, best.near_best.hits, best.near_best.count,
        std::floor(100.0 * best.near_best.low), std::ceil(100.0 * best.near_best.high)));
  }
  return verdicts;
}

std::string RobustTable(const RobustPlan& plan, const RobustResult& result,
                        const TerminalStyle& style) {
  std::string text = fmt::format("{}: {}\n{}\n\n", plan.sweep.file.name, plan.sweep.file.question,
                                 HandsText(plan));
  for (const RobustScore& score : result.scores) text += ScoreTableOf(result, score, style) + "\n";
  text +=
      "verdict: on the scenario's own hand, against the best there, as gauntlet compare gives it.\n"
      "best: hands on which no mean is better; as good: nearer to the best mean than the smallest\n"
      "difference that matters. In brackets the 95 % interval of that share, for other hands and\n"
      "the same seeds (Clopper and Pearson), each by itself.\n\n";
  for (const RobustScore& score : result.scores) {
    if (score.metric == plan.sweep.best_by) text += TornadoRows(plan, score, style);
  }
  text +=
      "high - low: seed by seed; all such intervals of all scores hold together with 95 %\n"
      "(Bonferroni). tornado.csv and report.html have the other scores.\n\n";
  if (result.not_built > 0) text += fmt::format("{} hands could not be built.\n", result.not_built);
  if (result.failed > 0) {
    text += fmt::format("{} times a controller's hand was stopped; it is not the best there.\n",
                        result.failed);
  }
  if (!result.first_problem.empty()) text += result.first_problem + "\n";
  text += fmt::format("{}\n", fmt::join(RobustVerdicts(result), "\n"));
  return text;
}

}  // namespace gauntlet::sim
