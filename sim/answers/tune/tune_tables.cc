#include "sim/answers/tune/tune_tables.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "controller/number.h"
#include "sim/answers/tune/filter_search.h"
#include "sim/base/data_folder.h"
#include "sim/base/json.h"
#include "sim/score/statistics/result_cells.h"
#include "sim/settings/input_unit.h"
#include "sim/settings/yaml_writer.h"

namespace gauntlet::sim {
namespace {

/// The scores of a setting with intervals, and the rest that is known of it.
std::vector<ResultColumn> ScoreColumns(const std::vector<std::size_t>& metrics) {
  std::vector<ResultColumn> columns = MetricColumns(metrics, "scores");
  columns.push_back({"constraints_met"});
  columns.push_back({"problem"});
  return columns;
}

void AddScores(const TunedSetting& setting, ResultRow& row) {
  for (const MeanInterval& score : setting.scores) row.push_back(CellOf(score));
  row.emplace_back(std::string(MetText(setting.met)));
  row.push_back(ResultCell::IfAny(setting.problem));
}

Json SettingJson(const TunePlan& plan, const TuneResult& result, const TunedSetting& setting) {
  return JsonOf(SettingsTable(plan, result, {setting}))[0];
}

Json ComparisonJson(const Comparison& comparison) {
  Json json = JsonOf(comparison.difference);
  json["verdict"] = JudgementText(comparison.judgement);
  return json;
}

/// Question and result of one controller.
Json ResultJson(const TunePlan& plan, const TuneResult& result) {
  Json json;
  json["tried"] = result.tried.size();
  if (!result.problem.empty()) {
    json["problem"] = result.problem;
  } else {
    json["tuned"] = SettingJson(plan, result, result.verdict);
    json["before"] = SettingJson(plan, result, result.before);
    json["gain"] = ComparisonJson(result.gain);
    for (std::size_t a = 0; a < plan.free.size(); ++a) {
      json["as_good"][plan.free[a].key] = {result.equal[a].low, result.equal[a].high};
    }
  }
  for (const std::size_t i : result.front) {
    json["front"].push_back(SettingJson(plan, result, result.tried[i]));
  }
  return json;
}

Json AskedJson(const TunePlan& plan, const TuneSplit& split) {
  return {{"scenario", PathFrom(std::filesystem::current_path(), plan.scenario.file)},
          {"controller", plan.controller},
          {"minimise", Metrics()[plan.minimise].key},
          {"physics", plan.physics},
          {"seeds", plan.seeds},
          {"held_out_seeds", plan.held_out},
          {"fitted_on", split.Text(TunePart::kFitted)},
          {"validated_on", split.Text(TunePart::kHeldOut)}};
}

constexpr std::size_t kMostOfFront = 12;

/// Some of the front, evenly.
ResultTable FrontTable(const TunePlan& plan, const TuneResult& result) {
  const std::size_t last = result.front.size() - 1;
  const std::size_t shown = std::min(result.front.size(), kMostOfFront);
  std::vector<TunedSetting> settings;
  for (std::size_t i = 0; i < shown; ++i) {
    const std::size_t at = shown == 1 ? 0 : (i * last + (shown - 1) / 2) / (shown - 1);
    settings.push_back(result.tried[result.front[at]]);
  }
  ResultTable table = SettingsTable(plan, result, settings);
  for (ResultColumn& column : table.columns) {
    const bool is_score = column.group == "scores";
    if (is_score && column.key != "delay_ms" && column.key != "jitter_rms_deg") column.heading = "";
  }
  return table;
}

/// "0.003 to 0.019", and where the range of the search ends within it.
std::string RangeText(const TunePlan& plan, const TuneResult& result, std::size_t axis) {
  const auto& [low, high] = result.equal[axis];
  std::string text = low == high ? low : fmt::format("{} to {}", low, high);
  const SweepAxis& range = plan.free[axis];
  if (!range.is_range()) return text;
  const bool ends_low = low == range.ValueAt(0.0);
  const bool ends_high = high == range.ValueAt(1.0);
  if (ends_low && ends_high) return text + " (the whole range)";
  if (ends_low || ends_high) {
    text += fmt::format(" (the range ends at {})", ends_low ? low : high);
  }
  return text;
}

/// Power of the input's unit in a free setting: see PowerOfInput().
int PowerOf(const TunePlan& plan, const TuneResult& result, std::size_t axis) {
  const std::string key = KeyInController(plan, axis);
  const std::vector<controller::FilterConfig>& filters = result.controller.config.filters;
  if (!key.starts_with("filter.") || filters.size() != 1) return 0;
  return PowerOfInput(filters.front().kind(), key.substr(key.rfind('.') + 1));
}

/// "Hz/(count/s)", "rad^2": of a setting whose value depends on the unit of the input.
std::string UnitOf(const TunePlan& plan, std::size_t axis, int power, const std::string& input) {
  if (power < 0) return fmt::format("Hz/({}/s)", input);
  if (power > 1) return fmt::format("{}^{}", input, power);
  const std::string& key = plan.free[axis].key;
  const std::string exponent = key.substr(key.rfind("_s") + 2);
  return fmt::format("{}/s{}{}", input, exponent.empty() ? "" : "^", exponent);
}

/// "beta is in Hz/(count/s): 0.0139 for a signal in deg, 0.797 in rad."
std::string UnitsText(const TunePlan& plan, const TuneResult& result) {
  const bool on_angle = result.controller.config.filter_on == controller::FilterOn::kAngle;
  std::vector<std::string> sentences;
  for (std::size_t a = 0; a < plan.free.size(); ++a) {
    const int power = PowerOf(plan, result, a);
    const auto value = controller::ParseNumber(result.tried[result.chosen].values[a]);
    if (power == 0 || !value) continue;
    const std::string& key = plan.free[a].key;
    const double in_rad = *value / std::pow(result.unit_per_rad, power);
    const double in_deg = in_rad * std::pow(kDegPerRad, power);
    sentences.push_back(fmt::format("{} is in {}: {:.3g} for a signal in deg{}.",
                                    key.substr(key.rfind('.') + 1),
                                    UnitOf(plan, a, power, on_angle ? "rad" : "count"), in_deg,
                                    on_angle ? "" : fmt::format(", {:.3g} in rad", in_rad)));
  }
  return fmt::format("{}", fmt::join(sentences, " "));
}

ResultTable ValuesTable(const TunePlan& plan, const TuneResult& result) {
  ResultTable table{
      .columns = {ForPeople("setting"), ForPeople("tuned"), ForPeople("equivalent range")}};
  for (std::size_t a = 0; a < plan.free.size(); ++a) {
    table.rows.push_back({ResultCell::Text(KeyInController(plan, a)),
                          ResultCell::Text(result.tried[result.chosen].values[a]),
                          ResultCell::Text(RangeText(plan, result, a))});
  }
  return table;
}

ResultTable HeldOutTable(const TunePlan& plan, const TuneResult& result) {
  ResultTable table{.columns = {ForPeople("held-out " + result.split.Noun()), ForPeople("before"),
                                ForPeople("tuned")}};
  for (std::size_t m = 0; m < result.metrics.size(); ++m) {
    table.rows.push_back({ResultCell::Text(fmt::format("{} [{}]", ScoreName(result.metrics[m]),
                                                       Metrics()[result.metrics[m]].unit)),
                          CellOf(result.before.scores[m]), CellOf(result.verdict.scores[m])});
  }
  if (!plan.constraints.empty()) {
    table.rows.push_back({ResultCell::Text("constraints"),
                          ResultCell::Text(MetText(result.before.met)),
                          ResultCell::Text(MetText(result.verdict.met))});
  }
  return table;
}

/// Why there is no confidence interval, if so; empty where there is one.
std::string WhyNoInterval(const TunePlan& plan, const TuneResult& result) {
  if (!result.before.problem.empty() || result.verdict.minimised.size() != 1) return "";
  if (result.split.by == TuneSplit::By::kBlocks) {
    return fmt::format("The {} has no values of blocks, so no confidence interval.",
                       ScoreName(plan.minimise));
  }
  return fmt::format("One held-out {} has no confidence interval.",
                     result.split.by == TuneSplit::By::kSeeds ? "seed" : "recording");
}

/// Warnings about the held-out part.
void AddDoubts(const TunePlan& plan, const TuneResult& result, Verdict& verdict) {
  if (result.split.is_fixed) {
    verdict.AddWarning("not_validated",
                       "Not validated: nothing is drawn at random and the motion is no recording, "
                       "so the settings are judged on the run that they were fitted to.");
  } else {
    verdict.AddWarning("one_seed", WhyNoInterval(plan, result));
  }
  if (!plan.physics) verdict.AddWithoutHand();
}

/// "keeps jitter_rms_deg<=0.1; closest is ..": why no kind has an answer.
std::string WhyNoKind(const TunePlan& plan, const std::vector<TunedKind>& kinds) {
  const std::vector<std::string> bounds = TextsOf(plan.constraints);
  const TunedKind* const nearest = NearestKind(kinds);
  const auto refused =
      std::ranges::find_if(kinds, [](const TunedKind& tuned) { return tuned.result.refused > 0; });
  if (refused != kinds.end()) {
    return fmt::format("No kind of filter keeps {} on the held-out {}; {} does on the fitted ones.",
                       fmt::join(bounds, ", "), refused->result.split.Noun(), refused->kind);
  }
  if (nearest == nullptr) return "No kind of filter meets the bounds.";
  const TunedSetting& setting = nearest->result.tried[*nearest->result.nearest];
  const std::string settings = SettingsText(nearest->plan, setting.values);
  return fmt::format("No kind of filter keeps {}; closest is {}{} with {}.",
                     fmt::join(bounds, ", "), nearest->kind,
                     settings.empty() ? "" : " (" + settings + ")",
                     BoundScoresText(nearest->plan, nearest->result, setting));
}

/// A primary score that is worse than before by a relevant difference, though the tuned score is
/// equivalent to that before; empty if there is none, or if the settings before keep no bounds.
std::string WorseForNothing(const TuneResult& result) {
  if (!result.before.problem.empty() || result.before.met > Met::kLikely ||
      result.gain.judgement != Judgement::kEqual) {
    return "";
  }
  for (std::size_t m = 0; m < result.metrics.size(); ++m) {
    const std::size_t metric = result.metrics[m];
    if (!IsPrimary(metric)) continue;
    const double before = result.before.scores[m].mean;
    const double tuned = result.verdict.scores[m].mean;
    if (tuned - before > RelevantDifferenceBetween(Metrics()[metric], before, tuned)) {
      return ScoreName(metric);
    }
  }
  return "";
}

}  // namespace

Verdict VerdictOf(const TunePlan& plan, const TuneResult& result) {
  if (!result.problem.empty()) return {.reasons = {{.key = "problem", .text = result.problem}}};
  Verdict verdict{.recommended = SettingsText(plan, result.tried[result.chosen].values)};
  std::vector<std::string> values;
  for (std::size_t m = 0; m < result.metrics.size(); ++m) {
    std::string value = NamedScore(result.metrics[m], result.verdict.scores[m].mean);
    if (!value.empty() && result.before.problem.empty()) {
      value += fmt::format(" (before {})", Short(result.before.scores[m].mean));
    }
    values.push_back(std::move(value));
  }
  if (const std::string worse = WorseForNothing(result); !worse.empty()) {
    verdict.AddHeadline("keep", fmt::format("Keep the settings of {}", plan.controller),
                        fmt::format(": {} gains nothing in {} and has more {}. Tuned: {}.",
                                    std::exchange(verdict.recommended, {}),
                                    ScoreName(plan.minimise), worse, Listed(values)));
  } else {
    verdict.AddHeadline("answer",
                        fmt::format("Use {} for {}", verdict.recommended, plan.controller),
                        fmt::format(": {}.", Listed(values)));
  }
  verdict.AddReason("units", UnitsText(plan, result));
  if (std::isfinite(result.gain.difference.low) && !result.split.is_fixed) {
    verdict.AddReason(
        "gain", fmt::format("The {} on the held-out {} is {}: {} {} against before, paired, {} CI.",
                            ScoreName(plan.minimise), result.split.Noun(),
                            JudgementWord(result.gain.judgement),
                            IntervalText(result.gain.difference), Metrics()[plan.minimise].unit,
                            result.refused > 0 ? "simultaneous 95 %" : "95 %"));
  }
  std::vector<std::string> ranges;
  for (std::size_t a = 0; a < plan.free.size(); ++a) {
    ranges.push_back(fmt::format("{} {}", KeyInController(plan, a), RangeText(plan, result, a)));
  }
  verdict.AddReason("equivalent", fmt::format("Equivalent settings: {}.", Listed(ranges)));
  AddDoubts(plan, result, verdict);
  return verdict;
}

Verdict VerdictOf(const TunePlan& plan, const std::vector<TunedKind>& kinds) {
  Verdict verdict;
  if (!kinds.front().has_answer()) {
    verdict.AddReason("constraints", WhyNoKind(plan, kinds));
    return verdict;
  }
  const TunedKind& chosen = kinds.front();
  const TuneSplit& split = chosen.result.split;
  verdict.recommended = chosen.kind;
  std::vector<std::string> undecided, better;
  for (const TunedKind& tuned : kinds) {
    if (&tuned == &chosen || !tuned.has_answer()) continue;
    const Judgement judgement = tuned.to_best.judgement;
    if (judgement == Judgement::kEqual) verdict.alternatives.push_back(tuned.kind);
    if (judgement == Judgement::kUndecided) undecided.push_back(tuned.kind);
    if (judgement == Judgement::kBetter) better.push_back(tuned.kind);
  }
  std::vector<std::string> values;
  for (std::size_t m = 0; m < chosen.result.metrics.size(); ++m) {
    values.push_back(NamedScore(chosen.result.metrics[m], chosen.result.verdict.scores[m].mean));
  }
  const std::string settings = SettingsText(chosen.plan, chosen.result.verdict.values);
  verdict.AddHeadline("best_by",
                      fmt::format("{} {}{}",
                                  undecided.empty() && better.empty()
                                      ? "Use"
                                      : fmt::format("Chosen on the fitted {}:", split.Noun()),
                                  chosen.kind, settings.empty() ? "" : " with " + settings),
                      fmt::format(": {}.", Listed(values)));
  verdict.AddReason("units", UnitsText(chosen.plan, chosen.result));
  if (!verdict.alternatives.empty()) {
    verdict.AddReason("equivalent", fmt::format("Equivalent in {}: {}.", ScoreName(plan.minimise),
                                                Listed(verdict.alternatives)));
  }
  if (!better.empty()) {
    verdict.AddHeadline(
        "better", "No recommendation",
        fmt::format(", as on the held-out {} it is worse than {}.", split.Noun(), Listed(better)));
    verdict.alternatives.insert(verdict.alternatives.begin(), better.begin(), better.end());
    verdict.recommended.clear();
  }
  if (better.empty()) verdict.AddUndecided(undecided, split.Cure());
  AddDoubts(chosen.plan, chosen.result, verdict);
  return verdict;
}

ResultTable SettingsTable(const TunePlan& plan, const TuneResult& result,
                          const std::vector<TunedSetting>& settings) {
  ResultTable table{.columns = {}, .rows = {}, .names = plan.free.size()};
  for (std::size_t a = 0; a < plan.free.size(); ++a) {
    table.columns.push_back(
        ResultColumn(plan.free[a].key, KeyInController(plan, a)).In("settings"));
  }
  std::ranges::move(ScoreColumns(result.metrics), std::back_inserter(table.columns));
  for (const TunedSetting& setting : settings) {
    ResultRow& row = table.rows.emplace_back();
    for (const std::string& value : setting.values) row.emplace_back(value);
    row.resize(plan.free.size());  // the controller as it is has no values of its own
    AddScores(setting, row);
  }
  return table;
}

std::string TuneCsv(const TunePlan& plan, const TuneResult& result) {
  return CsvOf(SettingsTable(plan, result, result.tried));
}

std::string TuneJson(const TunePlan& plan, const TuneResult& result) {
  Json json = AskedJson(plan, result.split);
  json.update(ResultJson(plan, result));
  json["verdict"] = JsonOf(VerdictOf(plan, result));
  return json.dump(1) + "\n";
}

std::string TuneCsv(const TunePlan&, const std::vector<TunedKind>& kinds) {
  ResultTable table{.columns = {OnlyInCsv("filter"), OnlyInCsv("settings"), OnlyInCsv("front")}};
  std::ranges::move(ScoreColumns(kinds.front().result.metrics), std::back_inserter(table.columns));
  for (const TunedKind& tuned : kinds) {
    for (std::size_t i = 0; i < tuned.result.tried.size(); ++i) {
      const TunedSetting& setting = tuned.result.tried[i];
      ResultRow& row = table.rows.emplace_back();
      row = {ResultCell(tuned.kind), ResultCell(SettingsText(tuned.plan, setting.values)),
             ResultCell(std::ranges::count(tuned.result.front, i) > 0)};
      AddScores(setting, row);
    }
  }
  return CsvOf(table);
}

std::string TuneJson(const TunePlan& plan, const std::vector<TunedKind>& kinds) {
  Json json = AskedJson(plan, SplitOfKinds(kinds));
  json["verdict"] = JsonOf(VerdictOf(plan, kinds));
  json["filters"] = Json::array();
  for (const TunedKind& tuned : kinds) {
    Json& entry = json["filters"].emplace_back(Json{{"filter", tuned.kind}});
    if (!tuned.left_out.empty()) {
      entry["left_out"] = tuned.left_out;
      continue;
    }
    if (tuned.has_answer()) entry["to_best"] = ComparisonJson(tuned.to_best);
    entry.update(ResultJson(tuned.plan, tuned.result));
  }
  return json.dump(1) + "\n";
}

std::string KeyInController(const TunePlan& plan, std::size_t axis) {
  return plan.free[axis].key.substr(std::string("controllers.").size() + plan.controller.size() +
                                    1);
}

std::string ControllerYaml(const NamedController& controller) {
  NamedController copy = controller;  // a visitor may change what it sees
  return SettingsToYaml([&copy](controller::SettingsVisitor& visitor) { copy.Visit(visitor); });
}

std::string QuestionText(const TunePlan& plan, const std::string& search) {
  const Metric& metric = Metrics()[plan.minimise];
  std::string text =
      fmt::format("{} of {}{}{}: {} {}", plan.controller, plan.scenario.file.stem().string(),
                  plan.physics ? "" : " (filters only, no hand)", search,
                  metric.lower_is_better ? "least" : "most", ScoreName(plan.minimise));
  for (const Constraint& constraint : plan.constraints) text += ", " + constraint.Text();
  return text;
}

std::string SplitText(const TuneSplit& split) {
  const std::string fitted = split.Text(TunePart::kFitted);
  if (split.is_fixed) return fitted + ", not validated";
  return fmt::format("{}, validated on {}", fitted, split.Text(TunePart::kHeldOut));
}

const TuneSplit& SplitOfKinds(const std::vector<TunedKind>& kinds) {
  return std::ranges::find(kinds, true,
                           [](const TunedKind& tuned) { return tuned.left_out.empty(); })
      ->result.split;
}

ResultText TuneText(const TunePlan& plan, const TuneResult& result, bool verbose) {
  ResultText text = {fmt::format("{}\n{} settings on {}", QuestionText(plan, ""),
                                 result.tried.size(), SplitText(result.split))};
  AddVerdict(VerdictOf(plan, result), text);
  text.emplace_back(HeldOutTable(plan, result));
  AddLine(TooFewTextIfAny(result.verdict.scores, result.verdict.minimised.size(), "--held-out 8"),
          text);
  if (result.refused > 0) {
    AddLine(fmt::format("{} better settings violated a bound on the held-out {}.", result.refused,
                        result.split.Noun()),
            text);
  }
  if (!verbose) return text;
  text.emplace_back(ValuesTable(plan, result));
  if (!result.front.empty()) {
    text.emplace_back("Pareto front of delay and jitter, of the settings tried:");
    text.emplace_back(FrontTable(plan, result));
  }
  return text;
}

ResultText TuneText(const TunePlan& plan, const std::vector<TunedKind>& kinds, bool verbose) {
  ResultTable table{.columns = {ForPeople("filter")}};
  std::ranges::move(MetricColumns(kinds.front().result.metrics, ""),
                    std::back_inserter(table.columns));
  table.columns.push_back(ForPeople("against\nthe chosen"));
  if (verbose) table.columns.push_back(ForPeople("settings").Words());
  std::string others;
  for (const TunedKind& tuned : kinds) {
    if (!tuned.has_answer()) {
      others += fmt::format("{}: {}\n", tuned.kind,
                            tuned.left_out.empty() ? tuned.result.problem : tuned.left_out);
      continue;
    }
    ResultRow& row = table.rows.emplace_back(ResultRow{ResultCell::Text(tuned.kind)});
    for (const MeanInterval& score : tuned.result.verdict.scores) {
      row.push_back(verbose ? CellOf(score) : ResultCell(score.mean));
    }
    row.push_back(ResultCell::Text(
        &tuned == &kinds.front() ? "chosen" : JudgementWord(tuned.to_best.judgement)));
    if (verbose) {
      row.push_back(ResultCell::Text(SettingsText(tuned.plan, tuned.result.verdict.values)));
    }
  }
  ResultText text = {fmt::format("{}\nat most {} settings of each kind on {}",
                                 QuestionText(plan, ", every kind of filter"), plan.evaluations,
                                 SplitText(SplitOfKinds(kinds)))};
  AddVerdict(VerdictOf(plan, kinds), text);
  text.emplace_back(std::move(table));
  if (verbose) text.emplace_back(others);
  return text;
}

}  // namespace gauntlet::sim
