#include "sim/answers/sweep/sweep_tables.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>

#include "sim/base/data_folder.h"
#include "sim/base/json.h"
#include "sim/base/shell_word.h"
#include "sim/score/statistics/result_cells.h"

namespace gauntlet::sim {
namespace {

std::vector<ResultColumn> CellColumns(const SweepPlan& plan) {
  std::vector<ResultColumn> columns = {{"cell", "no."}, {"controller", "controller"}};
  for (std::size_t a = 0; a < plan.file.axes.size(); ++a) {
    columns.push_back(ResultColumn(plan.file.axes[a].key, ShortKey(plan, a)).In("settings"));
  }
  columns.push_back({"seeds"});
  for (ResultColumn& column : MetricColumns(plan.metrics, "scores")) {
    columns.push_back(std::move(column));
  }
  columns.push_back({"constraints_met", plan.constraints.empty() ? "" : "bounds"});
  columns.push_back(OnlyInCsv("failed_trials"));
  columns.push_back(OnlyInJson("failed_trials"));  // where there are some
  columns.push_back({"problem"});
  columns.push_back(DifferenceColumn("to_best", "against\nthe best"));
  return columns;
}

ResultRow RowOf(const CellResult& result) {
  ResultRow row = {ResultCell(result.number), ResultCell(result.controller)};
  for (const std::string& value : result.values) row.emplace_back(value);
  row.emplace_back(std::int64_t{std::ssize(result.motions)});
  for (const MeanInterval& score : result.scores) row.push_back(CellOf(score));
  const std::int64_t failed = result.failed_trials;
  row.push_back(result.problem.empty() ? ResultCell(std::string(MetText(result.met)))
                                       : ResultCell());
  row.emplace_back(failed);
  row.push_back(failed > 0 ? ResultCell(failed) : ResultCell());
  row.push_back(ResultCell::IfAny(result.problem));
  row.emplace_back();
  return row;
}

void AddCounts(const SweepPlan& plan, const SweepSummary& summary, ResultText& text) {
  if (!plan.constraints.empty()) {
    AddLine(
        fmt::format("{} of {} meet {} (yes: the whole 95 % confidence interval, likely: the mean).",
                    summary.meeting, summary.results, fmt::join(TextsOf(plan.constraints), ", ")),
        text);
  }
  if (summary.not_built > 0)
    AddLine(Counted(summary.not_built, "setting") + " could not be built.", text);
  if (summary.failed > 0) {
    AddLine(fmt::format("Simulations failed in {}.", Counted(summary.failed, "setting")), text);
  }
  AddLine(summary.first_problem, text);
  if (summary.missing > 0)
    AddLine(Counted(summary.missing, "setting") + " have no result yet.", text);
  for (const CellResult& best : summary.best) {
    const std::string few = TooFewTextIfAny(best.scores, static_cast<std::size_t>(plan.file.seeds));
    AddLine(few, text);
    if (!few.empty()) break;
  }
}

/// "prediction with horizon_ms=50", "cell" being a word of files.
std::string SettingText(const SweepPlan& plan, const CellResult& cell) {
  std::string settings;
  for (std::size_t a = 0; a < cell.values.size(); ++a) {
    settings += fmt::format("{}{}={}", a == 0 ? "" : ", ", ShortKey(plan, a), cell.values[a]);
  }
  return settings.empty() ? cell.controller : cell.controller + " with " + settings;
}

/// The values at which a judgement holds; neighbouring values form one stretch, "0.5 to 2.5".
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

bool IsAnswer(const SweepPlan& plan, std::size_t metric) {
  return metric == plan.best_by || IsPrimary(metric);
}

/// Leaves the first rows, and of the scores the primary ones without their intervals.
void KeepAnswer(const SweepPlan& plan, std::size_t rows, ResultTable& table) {
  if (table.rows.size() > rows) table.rows.resize(rows);
  for (std::size_t c = 0; c < table.columns.size(); ++c) {
    if (table.columns[c].key == "seeds") table.columns[c].heading = "";
    const auto metric = FindMetric(table.columns[c].key);
    if (!metric || table.columns[c].group != "scores") continue;
    if (!IsAnswer(plan, *metric)) table.columns[c].heading = "";
    for (ResultRow& row : table.rows) {
      row[c].text = row[c].text.substr(0, row[c].text.find("±"));
    }
  }
}

}  // namespace

Verdict VerdictOf(const SweepPlan& plan, const SweepSummary& summary) {
  Verdict verdict;
  if (summary.best.empty()) {
    verdict.AddReason("constraints", "No setting meets all bounds.");
  } else {
    const auto name_of = [&](const CellResult& cell) { return SettingText(plan, cell); };
    const CellResult& best = summary.best.front();
    verdict.recommended = name_of(best);
    std::vector<std::string> undecided;
    for (const CellResult& cell : summary.best) {
      if (&cell == &best) continue;
      const Judgement judgement =
          CompareCells(plan, cell, best, PairsOf(static_cast<double>(summary.results))).judgement;
      if (judgement == Judgement::kEqual) verdict.alternatives.push_back(name_of(cell));
      if (judgement == Judgement::kUndecided) undecided.push_back(name_of(cell));
    }
    std::vector<std::string> values;
    for (std::size_t m = 0; m < plan.metrics.size(); ++m) {
      if (IsAnswer(plan, plan.metrics[m]))
        values.push_back(NamedScore(plan.metrics[m], best.scores[m].mean));
    }
    verdict.AddHeadline(
        "best_by",
        fmt::format("{} {}", undecided.empty() ? "Use" : "Best in the mean:", verdict.recommended),
        fmt::format(": {}.", Listed(values)));
    if (!verdict.alternatives.empty()) {
      verdict.AddReason("equivalent",
                        fmt::format("Equivalent in {}, of the settings below: {}.",
                                    ScoreName(plan.best_by), verdict.alternatives.size()));
    }
    verdict.AddUndecided(undecided, "More seeds can decide it.", "setting");
  }
  if (!plan.file.physics) verdict.AddWithoutHand();
  return verdict;
}

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

ResultTable BestCells(const SweepPlan& plan, const SweepSummary& summary) {
  const std::vector<CellResult>& shown = summary.best.empty() ? summary.near : summary.best;
  ResultTable table{.columns = CellColumns(plan), .rows = {}, .names = 2};
  for (const CellResult& result : shown) {
    table.rows.push_back(RowOf(result));
    const Comparison comparison =
        CompareCells(plan, result, shown.front(), PairsOf(static_cast<double>(summary.results)));
    ResultCell& to_best = table.rows.back().back();
    to_best = CellOf(comparison.difference, JudgementText(comparison.judgement));
    if (&result == &shown.front()) to_best.text = "best";
  }
  for (std::size_t c = 0; c < table.columns.size(); ++c) {
    if (std::ranges::all_of(table.rows, [c](const ResultRow& row) { return row[c].text == "-"; })) {
      table.columns[c].heading = "";  // no setting has this score
    }
  }
  return table;
}

SweepSummary WriteCellsCsv(const SweepPlan& plan, SweepDatabase& database, const CellRange& cells,
                           const std::function<void(std::string_view)>& write) {
  const std::vector<ResultColumn> columns = CellColumns(plan);
  write(CsvHead(columns));
  return SummariseSweep(plan, database, cells,
                        [&](const CellResult& result) { write(CsvRow(columns, RowOf(result))); });
}

void WriteSweepJson(const SweepPlan& plan, SweepDatabase& database, const CellRange& cells,
                    const SweepSummary& summary,
                    const std::function<void(std::string_view)>& write) {
  Json head = {{"sweep", plan.file.name},
               {"question", plan.file.question},
               {"scenario", PathFrom(std::filesystem::current_path(), plan.file.scenario)},
               {"physics", plan.file.physics},
               {"seeds", plan.file.seeds},
               {"best_by", Metrics()[plan.best_by].key},
               {"constraints", TextsOf(plan.constraints)},
               {"results", summary.results},
               {"meeting", summary.meeting},
               {"not_built", summary.not_built},
               {"failed", summary.failed},
               {"missing", summary.missing},
               {"verdict", JsonOf(VerdictOf(plan, summary))},
               {"best", Json::array()}};
  if (!summary.best.empty()) head["best"] = JsonOf(BestCells(plan, summary));
  std::string text = head.dump(1);
  text.erase(text.find_last_of('\n'));  // the brace, as the cells follow
  write(text + ",\n \"cells\": [");
  const std::vector<ResultColumn> columns = CellColumns(plan);
  const char* before = "\n";
  ForEachCell(plan, database, cells, [&](const CellResult& result) {
    write(before + JsonOf(columns, RowOf(result)).dump());
    before = ",\n";
  });
  write("\n]\n}\n");
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
          fmt::format("{} at {}", JudgementWord(judgement), fmt::join(stretches, ", ")));
    }
    if (parts.empty()) continue;
    text += fmt::format("{}{} against {}, by {}: {}.", text.empty() ? "" : "\n", verdict.controller,
                        response.controllers.front(), ShortKey(plan, 0), fmt::join(parts, "; "));
  }
  if (text.empty()) return "";
  return text + fmt::format("\nIn {}, paired by seed, simultaneous 95 % ({} pairs, Bonferroni).",
                            ScoreName(plan.best_by), response.comparisons);
}

ResultText SweepText(const SweepPlan& plan, const SweepSummary& summary, const Response& response,
                     bool verbose) {
  constexpr std::size_t kFewRows = 5;
  ResultTable best = BestCells(plan, summary);
  const std::size_t shown = best.rows.size();
  if (!verbose) KeepAnswer(plan, kFewRows, best);
  ResultText text = {
      fmt::format("{}: {}\n{}, {}{}; best by {}", plan.file.name, plan.file.question,
                  Counted(plan.cell_count(), "setting"), Counted(plan.file.seeds, "seed"),
                  plan.file.physics ? "" : ", filters only, no hand", ScoreName(plan.best_by))};
  AddVerdict(VerdictOf(plan, summary), text);
  text.emplace_back(std::move(best));
  AddCounts(plan, summary, text);
  if (verbose && shown > 1) {
    AddLine(fmt::format("To the best: in {}, paired by seed, simultaneous 95 % ({} pairs, "
                        "Bonferroni).",
                        ScoreName(plan.best_by), summary.results * (summary.results - 1) / 2),
            text);
  }
  text.emplace_back(ResponseText(plan, response));
  if (!summary.best.empty()) {
    text.emplace_back(
        CommandLines{RepeatCommand(plan, NameHere(plan.file.scenario),
                                   summary.best.front().controller, summary.best.front().number)});
  }
  return text;
}

}  // namespace gauntlet::sim
