#include "sim/report/sweep_table.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>

#include "sim/base/data_folder.h"
#include "sim/base/shell_word.h"

namespace gauntlet::sim {
namespace {

std::string Cells(std::int64_t count) {
  return fmt::format("{} cell{}", count, count == 1 ? "" : "s");
}

std::string CountsText(const SweepPlan& plan, const SweepSummary& summary) {
  std::string text;
  if (!plan.constraints.empty()) {
    std::vector<std::string> bounds;
    for (const Constraint& constraint : plan.constraints) bounds.push_back(constraint.Text());
    text += fmt::format(
        "{} of {} keep {} (yes: with the whole 95 % interval, likely: with the "
        "mean).\n",
        summary.meeting, summary.results, fmt::join(bounds, ", "));
  }
  if (summary.not_built > 0) text += Cells(summary.not_built) + " could not be built.\n";
  if (summary.failed > 0) text += fmt::format("In {} a hand was stopped.\n", Cells(summary.failed));
  if (!summary.first_problem.empty()) text += summary.first_problem + "\n";
  if (summary.stopped > 0 && summary.stopped < summary.results) {
    text += fmt::format(
        "{} of {} were stopped early, which saved {} of {} trials: they could not win any more\n"
        "(sequential test, 5 % for all looks and cells; --all-seeds runs them to the end).\n",
        summary.stopped, summary.results, summary.trials_saved, summary.results * plan.file.seeds);
  }
  if (summary.missing > 0) text += Cells(summary.missing) + " are not there yet.\n";
  return text;
}

/// Where a judgement holds: neighbouring values as one stretch, "0.5 to 2.5".
std::vector<std::string> StretchesOf(const ResponseVerdict& verdict, Judgement judgement,
                                     const std::vector<std::string>& values) {
  std::vector<std::string> stretches;
  for (std::size_t begin = 0; begin < values.size(); ++begin) {
    if (verdict.judgements[begin] != judgement) continue;
    std::size_t end = begin;
    while (end + 1 < values.size() && verdict.judgements[end + 1] == judgement) ++end;
    stretches.push_back(begin == end ? values[begin] : values[begin] + " to " + values[end]);
    begin = end;
  }
  return stretches;
}

}  // namespace

std::string ShortKey(const SweepPlan& plan, std::size_t axis) {
  const std::string& key = plan.file.axes[axis].key;
  for (std::size_t dot = key.rfind('.'); dot != std::string::npos && dot > 0;
       dot = key.rfind('.', dot - 1)) {
    const std::string ending = key.substr(dot);
    const auto same = std::ranges::count_if(
        plan.file.axes, [&](const SweepAxis& other) { return other.key.ends_with(ending); });
    if (same == 1 && !FindMetric(ending.substr(1))) return ending.substr(1);
  }
  return key;
}

std::string NameHere(const std::filesystem::path& file) {
  return PathFrom(std::filesystem::current_path(), file);
}

std::string CompareCommand(const std::string& scenario, int seeds, const std::string& controller,
                           const std::vector<std::string>& sets) {
  std::string command = fmt::format("gauntlet compare {} --seeds {}", ShellPath(scenario), seeds);
  if (!controller.empty()) {
    command += controller.starts_with('-') ? " --controllers=" : " --controllers ";
    command += ShellWord(controller);
  }
  for (const std::string& set : sets) command += fmt::format(" \\\n  --set {}", ShellWord(set));
  return command + "\n";
}

std::string RepeatCommand(const SweepPlan& plan, const std::string& scenario,
                          const std::string& controller, std::int64_t cell) {
  std::vector<std::string> sets = plan.file.set;
  for (const std::string& override : plan.OverridesOf(cell)) sets.push_back(override);
  return CompareCommand(scenario, plan.file.seeds, controller, sets);
}

std::string ResponseText(const SweepPlan& plan, const Response& response) {
  std::string text;
  for (const ResponseVerdict& verdict : response.verdicts) {
    std::vector<std::string> parts;
    for (const Judgement judgement :
         {Judgement::kBetter, Judgement::kEqual, Judgement::kUndecided, Judgement::kWorse}) {
      const std::vector<std::string> stretches = StretchesOf(verdict, judgement, response.texts);
      if (stretches.empty()) continue;
      parts.push_back(
          fmt::format("{} at {}", JudgementText(judgement), fmt::join(stretches, ", ")));
    }
    if (parts.empty()) continue;
    text += fmt::format("{} against {}, by {}: {}.\n", verdict.controller,
                        response.controllers.front(), ShortKey(plan, 0), fmt::join(parts, "; "));
  }
  if (text.empty()) return "";
  return text + fmt::format(
                    "In {}, paired by seed; all {} comparisons hold together with 95 % "
                    "(Bonferroni).\n",
                    Metrics()[plan.best_by].key, response.comparisons);
}

std::string SweepTable(const SweepPlan& plan, const SweepSummary& summary, const Response& response,
                       const TerminalStyle& style) {
  const Metric& best_by = Metrics()[plan.best_by];
  std::string text =
      fmt::format("{}: {}\n{}, {} seed{}{}; best by {}\n\n", plan.file.name, plan.file.question,
                  Cells(plan.cell_count()), plan.file.seeds, plan.file.seeds == 1 ? "" : "s",
                  plan.file.physics ? "" : ", filters only, no hand", best_by.key);
  std::vector<std::vector<std::string>> rows;
  std::vector<std::string>& head = rows.emplace_back();
  head = {"cell", "controller"};
  for (std::size_t a = 0; a < plan.file.axes.size(); ++a) head.push_back(ShortKey(plan, a));
  for (const std::size_t metric : plan.metrics) head.emplace_back(Metrics()[metric].key);
  const bool some_stopped = summary.stopped > 0 && summary.stopped < summary.results;
  if (some_stopped) head.emplace_back("seeds");
  if (!plan.constraints.empty()) head.emplace_back("constraints");
  head.emplace_back("to the best");
  const std::vector<CellResult>& shown = summary.best.empty() ? summary.near : summary.best;
  for (const CellResult& result : shown) {
    std::vector<std::string>& row = rows.emplace_back();
    row = {std::to_string(result.number), result.controller};
    row.insert(row.end(), result.values.begin(), result.values.end());
    for (const MeanInterval& score : result.scores) row.push_back(IntervalText(score));
    if (some_stopped) row.push_back(std::to_string(result.motions.size()));
    if (!plan.constraints.empty()) row.emplace_back(MetText(result.met));
    const CellComparison comparison = CompareCells(plan, result, shown.front(), summary.results);
    const std::string_view judgement = JudgementText(comparison.judgement);
    row.emplace_back(&result == &shown.front() ? "best" : judgement);
  }
  if (!shown.empty()) text += AlignedTable(rows, style, 2) + "\n";
  if (summary.best.empty()) text += "No cell keeps all constraints.\n";
  text += CountsText(plan, summary);
  if (shown.size() > 1) {
    text += fmt::format(
        "To the best: in {}, paired by seed; all {} pairs hold together with 95 % "
        "(Bonferroni).\n",
        best_by.key, summary.results * (summary.results - 1) / 2);
  }
  if (const std::string curve = ResponseText(plan, response); !curve.empty()) text += "\n" + curve;
  if (!plan.file.physics) text += "Without a hand: confirm with physics before it counts.\n";
  if (!summary.best.empty())
    text += fmt::format(
        "\n{}", RepeatCommand(plan, NameHere(plan.file.scenario), summary.best.front().controller,
                              summary.best.front().number));
  return text;
}

}  // namespace gauntlet::sim
