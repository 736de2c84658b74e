#include "sim/answers/robust/robust_tables.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "sim/base/json.h"
#include "sim/score/statistics/result_cells.h"

namespace gauntlet::sim {
namespace {

ResultCell CellOf(const Share& share) {
  return {{std::int64_t{share.count}, std::int64_t{share.hits}, share.low, share.high},
          fmt::format("{} of {} {}({})", share.hits, share.count, kSoftBreak, PercentText(share))};
}

/// `of`: what CSV calls the number of all hands.
ResultColumn ShareColumn(const std::string& key, const std::string& heading,
                         const std::string& of) {
  return {key,
          heading,
          "",
          {{"of", of},
           {"hands", key + "_hands"},
           {"ci95_low", key + "_low"},
           {"ci95_high", key + "_high"}}};
}

/// With the level, as the intervals of the tornado have one of their own.
ResultColumn LevelColumn(const std::string& key, const std::string& heading,
                         const std::string& level = {}) {
  return {key,
          heading,
          "",
          {{"mean", key}, {"low", key + "_low"}, {"high", key + "_high"}, {"level", level}}};
}

ResultCell LevelCell(const MeanInterval& interval) {
  return {{interval.mean, interval.low, interval.high, interval.level}, IntervalText(interval)};
}

/// The tables of all scores below each other.
template <class TableOf>
std::string CsvOfScores(const RobustResult& result, const TableOf& table_of) {
  std::string text;
  for (const RobustScore& score : result.scores) {
    const ResultTable table = table_of(score);
    if (text.empty()) text = CsvHead(table.columns);
    for (const ResultRow& row : table.rows) text += CsvRow(table.columns, row);
  }
  return text;
}

/// "Sensitive to friction: .."; of the difference between the two best controllers.
std::string Sensitivity(const RobustPlan& plan, const RobustScore& score) {
  if (score.bars.empty()) return "";
  std::vector<std::string> matters, open;
  for (const TornadoBar& bar : score.bars) {
    const std::string& name = plan.parameters[bar.parameter].name;
    const Judgement judgement = bar.change.judgement;
    if (judgement == Judgement::kBetter || judgement == Judgement::kWorse) matters.push_back(name);
    if (judgement == Judgement::kUndecided) open.push_back(name);
  }
  std::string text = fmt::format("The difference in {} between {} and {} is sensitive to {}",
                                 ScoreName(score.metric), score.controllers[score.two_best[0]].name,
                                 score.controllers[score.two_best[1]].name,
                                 matters.empty() ? "no parameter" : Listed(matters));
  if (!open.empty()) text += fmt::format("; undecided for {}", Listed(open));
  return text + ".";
}

/// A row for each controller: on how many hands it is best or equivalent, score by score.
ResultTable HandsTable(const RobustResult& result) {
  ResultTable table{.columns = {ForPeople("best or equivalent on")}};
  for (const RobustScore& score : result.scores) {
    table.columns.push_back(ForPeople(ScoreHeading(score.metric)));
  }
  for (const std::size_t c : result.nominal.answer.order) {
    ResultRow& row =
        table.rows.emplace_back(ResultRow{ResultCell::Text(result.nominal.controllers[c].name)});
    for (const RobustScore& score : result.scores) {
      const Share& share = score.controllers[c].near_best;
      row.push_back(ResultCell::Text(fmt::format("{}/{}", share.hits, share.count)));
    }
  }
  return table;
}

/// A row per controller: one score on the nominal hand, and on how many others it is best.
ResultTable RobustScoreTable(const RobustResult& result, const RobustScore& score) {
  const std::string key(Metrics()[score.metric].key);
  ResultTable table{
      .columns = {OnlyInCsv("score"),
                  {"name", key, "", {{"name", "controller"}}},
                  LevelColumn("nominal", "nominal hand"),
                  DifferenceColumn("nominal_to_best", "verdict", "nominal_verdict_to_best"),
                  ShareColumn("best", "best", "hands"),
                  ShareColumn("near_best", "equivalent", "")}};
  for (std::size_t c = 0; c < score.controllers.size(); ++c) {
    const ControllerSummary& nominal = result.nominal.controllers[c];
    const bool is_best = score.two_best.front() == c;
    const Comparison to_best =
        is_best ? Comparison{} : result.nominal.Of(score.metric, c, score.two_best.front());
    table.rows.push_back(
        {ResultCell(key), ResultCell(nominal.name), LevelCell(nominal.summary[score.metric]),
         CellOf(to_best.difference, is_best ? "best" : JudgementText(to_best.judgement)),
         CellOf(score.controllers[c].best), CellOf(score.controllers[c].near_best)});
  }
  return table;
}

/// A row per parameter: what it does to the difference between the two that are best.
ResultTable TornadoTable(const RobustPlan& plan, const RobustScore& score) {
  ResultTable table{.columns = {OnlyInCsv("score"),
                                {"first"},
                                {"second"},
                                {"parameter", "parameter"},
                                LevelColumn("low", "low"),
                                LevelColumn("high", "high"),
                                LevelColumn("change", "high - low", "level"),
                                {"relevant_difference"},
                                ResultColumn("verdict", "verdict").Words(),
                                {"problem"}}};
  for (const TornadoBar& bar : score.bars) {
    ResultRow row = {ResultCell(std::string(Metrics()[score.metric].key)),
                     ResultCell(score.controllers[score.two_best[0]].name),
                     ResultCell(score.controllers[score.two_best[1]].name),
                     ResultCell(plan.parameters[bar.parameter].name)};
    if (bar.problem.empty()) {
      row.insert(row.end(),
                 {LevelCell(bar.low), LevelCell(bar.high), LevelCell(bar.change.difference),
                  ResultCell(bar.change.relevant_difference),
                  ResultCell(std::string(TornadoVerdict(bar))), ResultCell()});
    } else {
      row.insert(row.end(), {ResultCell::Text("-"), ResultCell::Text("-"), ResultCell::Text("-"),
                             ResultCell(), ResultCell::Text(bar.problem), ResultCell(bar.problem)});
    }
    table.rows.push_back(std::move(row));
  }
  return table;
}

/// Description of the hands: "32 hands, each with friction, delay ... within 30 % of the
/// scenario's".
std::string HandsText(const RobustPlan& plan) {
  std::vector<std::string> names;
  for (const RobustParameter& parameter : plan.parameters) names.push_back(parameter.name);
  std::string text = fmt::format("{} hands, each with {} within {:g} % of the scenario's",
                                 plan.hands, fmt::join(names, ", "), plan.within_percent);
  if (!plan.not_varied.empty()) {
    text += fmt::format(" (not {}, which {} 0 there)", fmt::join(plan.not_varied, ", "),
                        plan.not_varied.size() == 1 ? "is" : "are");
  }
  return text + fmt::format("; {} each", Counted(plan.sweep.file.seeds, "seed"));
}

}  // namespace

std::string PercentText(const Share& share) {
  return fmt::format("{:.0f} to {:.0f} %", std::floor(100.0 * share.low),
                     std::ceil(100.0 * share.high));
}

std::string JudgedController(const RobustPlan& plan, const RobustResult& result) {
  const auto score = std::ranges::find(result.scores, plan.sweep.best_by, &RobustScore::metric);
  return score == result.scores.end() ? ""
                                      : result.nominal.answer.verdict.best_or(
                                            score->controllers[score->two_best.front()].name);
}

Verdict VerdictOf(const RobustPlan& plan, const RobustResult& result) {
  const Verdict& nominal = result.nominal.answer.verdict;
  const std::string name = JudgedController(plan, result);
  Verdict verdict;
  for (const RobustScore& score : result.scores) {
    if (score.metric != plan.sweep.best_by) continue;
    const RobustController& judged =
        *std::ranges::find(score.controllers, name, &RobustController::name);
    const std::string hands = fmt::format("{} of {} hands (95 % CI {})", judged.near_best.hits,
                                          judged.near_best.count, PercentText(judged.near_best));
    if (nominal.recommended.empty()) {
      verdict.alternatives = nominal.alternatives;
      verdict.AddHeadline(
          "undecided", "No recommendation on the nominal hand",
          fmt::format(": more seeds are needed. {} has the least {} there, and is best or "
                      "equivalent on {}.",
                      name, ScoreName(score.metric), hands));
    } else {
      verdict.recommended = name;
      verdict.alternatives = nominal.alternatives;
      verdict.AddHeadline(
          "recommended", fmt::format("Use {}", name),
          fmt::format(": recommended on the nominal hand, and best or equivalent in {} on {}.",
                      ScoreName(score.metric), hands));
    }
    verdict.AddReason("sensitivity", Sensitivity(plan, score));
  }
  return verdict;
}

std::string_view TornadoVerdict(const TornadoBar& bar) {
  static constexpr std::string_view kWords[] = {"", "effect", "no effect", "undecided", "effect"};
  return kWords[static_cast<std::size_t>(bar.change.judgement)];
}

std::string RobustCsv(const RobustResult& result) {
  return CsvOfScores(result,
                     [&](const RobustScore& score) { return RobustScoreTable(result, score); });
}

std::string TornadoCsv(const RobustPlan& plan, const RobustResult& result) {
  return CsvOfScores(result, [&](const RobustScore& score) { return TornadoTable(plan, score); });
}

std::string RobustJson(const RobustPlan& plan, const RobustResult& result) {
  Json json = {{"scenario", plan.sweep.file.name},
               {"question", plan.sweep.file.question},
               {"hands", plan.hands},
               {"within_percent", plan.within_percent},
               {"seeds", plan.sweep.file.seeds},
               {"parameters", Json::array()},
               {"not_varied", plan.not_varied},
               {"not_built", result.not_built},
               {"failed", result.failed},
               {"verdict", JsonOf(VerdictOf(plan, result))},
               {"scores", Json::array()}};
  for (const RobustParameter& parameter : plan.parameters) {
    json["parameters"].push_back({{"name", parameter.name}, {"is", parameter.help}});
  }
  for (const RobustScore& score : result.scores) {
    json["scores"].push_back({{"score", Metrics()[score.metric].key},
                              {"controllers", JsonOf(RobustScoreTable(result, score))},
                              {"tornado", JsonOf(TornadoTable(plan, score))}});
  }
  return json.dump(1) + "\n";
}

ResultText RobustText(const RobustPlan& plan, const RobustResult& result, bool verbose) {
  ResultText text = {fmt::format("{}: Does the verdict hold on {} other hands?",
                                 plan.sweep.file.name, plan.hands)};
  AddVerdict(VerdictOf(plan, result), text);
  text.emplace_back(HandsTable(result));
  AddLine(HandsText(plan) + ".", text);
  if (result.not_built > 0) {
    AddLine(fmt::format("Warning: {} could not be built.", Counted(result.not_built, "hand")),
            text);
  }
  if (result.failed > 0) {
    AddLine(fmt::format("Warning: {} failed; their controller does not count as best there.",
                        Counted(result.failed, "simulation")),
            text);
  }
  AddLine(result.first_problem, text);
  if (!verbose) return text;
  for (const RobustScore& score : result.scores) {
    text.emplace_back(RobustScoreTable(result, score));
  }
  std::vector<MeanInterval> shown;
  for (const RobustScore& score : result.scores) {
    for (const ControllerSummary& nominal : result.nominal.controllers) {
      shown.push_back(nominal.summary[score.metric]);
    }
    for (const TornadoBar& bar : score.bars) shown.push_back(bar.change.difference);
  }
  AddLine(TooFewTextIfAny(shown, static_cast<std::size_t>(plan.sweep.file.seeds)), text);
  AddLine(
      "verdict: difference to the best on the nominal hand, as gauntlet compare judges it. best: "
      "share of hands with the lowest mean. equivalent: share of hands with a mean within the "
      "smallest relevant difference of the lowest. In brackets: 95 % confidence interval of the "
      "share, for other hands and the same seeds (Clopper and Pearson).",
      text);
  for (const RobustScore& score : result.scores) {
    if (score.metric != plan.sweep.best_by || score.bars.empty()) continue;
    text.emplace_back(fmt::format("Sensitivity of {} - {} in {}, one parameter at a time",
                                  score.controllers[score.two_best[0]].name,
                                  score.controllers[score.two_best[1]].name,
                                  ScoreName(score.metric)));
    text.emplace_back(TornadoTable(plan, score));
  }
  AddLine(
      "high - low: paired by seed, simultaneous 95 % confidence intervals (Bonferroni). "
      "tornado.csv "
      "and report.html contain the other scores.",
      text);
  return text;
}

}  // namespace gauntlet::sim
