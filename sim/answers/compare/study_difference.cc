#include "sim/answers/compare/study_difference.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "sim/base/error.h"
#include "sim/base/text.h"
#include "sim/score/score.h"
#include "sim/score/statistics/result_cells.h"

namespace gauntlet::sim {
namespace {

constexpr std::string_view kVersions = "made_with.";
constexpr double kRounding = 1e-9;

std::vector<std::string> NotIn(const std::vector<std::string>& names,
                               const std::vector<std::string>& others) {
  std::vector<std::string> missing = names;
  std::erase_if(missing,
                [&](const std::string& name) { return std::ranges::count(others, name) > 0; });
  return missing;
}

/// Contacts and constraints are other numbers in each MuJoCo. Errors: UserError.
void CheckEngines(const StudyFolder& a, const StudyFolder& b) {
  const std::string& engine_a = a.scenario.made_with.mujoco_version;
  const std::string& engine_b = b.scenario.made_with.mujoco_version;
  if (engine_a.empty() || engine_b.empty() || engine_a == engine_b) return;
  throw UserError({.place = b.name,
                   .problem = fmt::format("was computed with MuJoCo {}, {} with {}: scores of two "
                                          "engines are not compared",
                                          Shown(engine_b), a.name, Shown(engine_a))});
}

// --- settings -----------------------------------------------------------------------------------

/// The settings without those of controllers that the other folder does not have.
std::vector<SettingValue> SharedSettings(const StudyFolder& folder,
                                         const std::vector<std::string>& only_here) {
  std::vector<SettingValue> values = SettingValues(folder.scenario);
  for (const std::string& controller : only_here) {
    const std::string prefix = "controllers." + controller + ".";
    std::erase_if(values, [&](const SettingValue& value) { return value.key.starts_with(prefix); });
  }
  return values;
}

std::vector<SettingDifference> DifferentSettings(const std::vector<SettingValue>& a,
                                                 const std::vector<SettingValue>& b) {
  std::map<std::string, std::string> rest;  // of B, without what A has too
  for (const SettingValue& value : b) rest.emplace(value.key, value.value);
  std::vector<SettingDifference> differences;
  for (const SettingValue& value : a) {
    const auto found = rest.find(value.key);
    if (found == rest.end()) {
      differences.push_back({value.key, value.value, std::nullopt});
      continue;
    }
    if (found->second != value.value) {
      differences.push_back({value.key, value.value, found->second});
    }
    rest.erase(found);
  }
  for (const SettingValue& value : b) {
    if (rest.contains(value.key)) differences.push_back({value.key, std::nullopt, value.value});
  }
  return differences;
}

// --- scores -------------------------------------------------------------------------------------

DifferenceMethod MethodFor(const ScoreFile& a, const ScoreFile& b, std::size_t common_seeds) {
  if (common_seeds > 1) return DifferenceMethod::kPaired;
  const bool groups = a.seeds.size() > 1 && b.seeds.size() > 1;
  return common_seeds == 0 && groups ? DifferenceMethod::kUnpaired : DifferenceMethod::kPlain;
}

/// B - A. Pairs of which too few have both scores are compared as groups.
MeanInterval DifferenceOf(const std::vector<double>& a, const std::vector<double>& b,
                          DifferenceMethod method) {
  if (method == DifferenceMethod::kPaired) {
    const MeanInterval paired = EstimateDifference(b, a).IntervalAt();
    if (std::isfinite(paired.low)) return paired;
  }
  return EstimateUnpairedDifference(b, a).IntervalAt();
}

ScoreChange ChangeOf(const ScoreDifference& score, bool lower_is_better) {
  if (std::isnan(score.b)) return ScoreChange::kOnlyInA;
  if (std::isnan(score.a)) return ScoreChange::kOnlyInB;
  const MeanInterval& difference = score.difference;
  if (!(std::abs(difference.mean) > kRounding * std::max(std::abs(score.a), std::abs(score.b)))) {
    return ScoreChange::kNone;
  }
  if (difference.low <= 0.0 && 0.0 <= difference.high) return ScoreChange::kNone;
  return (difference.mean < 0.0) == lower_is_better ? ScoreChange::kBetter : ScoreChange::kWorse;
}

/// The scores of one controller that A or B has.
void CompareScores(const std::string& controller, const std::vector<std::vector<double>>& a,
                   const std::vector<std::vector<double>>& b, StudyDifference& result) {
  const bool other_joints =
      !result.channels_only_in_a.empty() || !result.channels_only_in_b.empty();
  for (std::size_t m = 0; m < Metrics().size(); ++m) {
    ScoreDifference score{.controller = controller,
                          .metric = m,
                          .a = MeanOfFinite(a[m]),
                          .b = MeanOfFinite(b[m]),
                          .difference = DifferenceOf(a[m], b[m], result.method),
                          .change = ScoreChange::kNone};
    if (std::isnan(score.a) && std::isnan(score.b)) continue;
    score.change = ChangeOf(score, Metrics()[m].lower_is_better);
    const bool judged = score.change == ScoreChange::kBetter || score.change == ScoreChange::kWorse;
    if (judged && other_joints && Metrics()[m].part != ScoredPart::kHand) {
      score.change = ScoreChange::kOtherJoints;
    }
    result.scores.push_back(std::move(score));
  }
}

// --- JSON ---------------------------------------------------------------------------------------

Json SettingsJson(const std::vector<SettingDifference>& settings) {
  const auto text = [](const std::optional<std::string>& value) {
    return value ? Json(*value) : Json(nullptr);
  };
  Json json = Json::array();
  for (const SettingDifference& setting : settings) {
    json.push_back({{"key", setting.key}, {"a", text(setting.a)}, {"b", text(setting.b)}});
  }
  return json;
}

Json FolderJson(const StudyFolder& folder) {
  return {{"folder", folder.name},
          {"scenario", folder.scenario.name},
          {"seeds", folder.scores.seeds},
          {"gauntlet_version", folder.scenario.made_with.gauntlet_version},
          {"model_hash", folder.scenario.made_with.model_hash}};
}

}  // namespace

double MeanOfFinite(const std::vector<double>& values) {
  double sum = 0.0;
  int count = 0;
  for (const double value : values) {
    if (!std::isfinite(value)) continue;
    sum += value;
    ++count;
  }
  return count > 0 ? sum / count : kNaN;
}

std::size_t StudyDifference::ChangedScores() const {
  return static_cast<std::size_t>(std::count_if(
      scores.begin(), scores.end(),
      [](const ScoreDifference& score) { return score.change != ScoreChange::kNone; }));
}

bool StudyDifference::Same() const {
  return settings.empty() && controllers_only_in_a.empty() && controllers_only_in_b.empty() &&
         channels_only_in_a.empty() && channels_only_in_b.empty() && ChangedScores() == 0;
}

std::vector<int> CommonSeeds(const std::vector<int>& a, const std::vector<int>& b) {
  std::vector<int> common = a;
  std::erase_if(common, [&](int seed) { return std::ranges::count(b, seed) == 0; });
  return common;
}

ScoreFile OfSeeds(const std::vector<int>& seeds, ScoreFile scores) {
  if (seeds.empty()) return scores;
  for (auto& controller : scores.summary) {
    for (std::vector<double>& values : controller) {
      std::vector<double> ordered;
      for (const int seed : seeds) {
        const auto place = std::find(scores.seeds.begin(), scores.seeds.end(), seed);
        ordered.push_back(values[static_cast<std::size_t>(place - scores.seeds.begin())]);
      }
      values = std::move(ordered);
    }
  }
  scores.seeds = seeds;
  return scores;
}

StudyDifference CompareStudies(const StudyFolder& a, const StudyFolder& b) {
  CheckEngines(a, b);
  StudyDifference result;
  result.controllers_only_in_a = NotIn(a.scores.controllers, b.scores.controllers);
  result.controllers_only_in_b = NotIn(b.scores.controllers, a.scores.controllers);
  result.channels_only_in_a = NotIn(a.scores.channels, b.scores.channels);
  result.channels_only_in_b = NotIn(b.scores.channels, a.scores.channels);
  for (SettingDifference& setting :
       DifferentSettings(SharedSettings(a, result.controllers_only_in_a),
                         SharedSettings(b, result.controllers_only_in_b))) {
    const bool version = setting.key.starts_with(kVersions);
    (version ? result.versions : result.settings).push_back(std::move(setting));
  }
  for (std::size_t m = 0; m < Metrics().size(); ++m) {
    const std::string key(Metrics()[m].key);
    if (!b.scores.has_metric[m] && a.scores.has_metric[m]) result.metrics_only_in_a.push_back(key);
    if (!a.scores.has_metric[m] && b.scores.has_metric[m]) result.metrics_only_in_b.push_back(key);
  }
  result.common_seeds = CommonSeeds(a.scores.seeds, b.scores.seeds);
  result.method = MethodFor(a.scores, b.scores, result.common_seeds.size());
  const ScoreFile a_scores = OfSeeds(result.common_seeds, a.scores);
  const ScoreFile b_scores = OfSeeds(result.common_seeds, b.scores);
  for (std::size_t c = 0; c < a_scores.controllers.size(); ++c) {
    const std::string& name = a_scores.controllers[c];
    const auto found = std::find(b_scores.controllers.begin(), b_scores.controllers.end(), name);
    if (found == b_scores.controllers.end()) continue;
    const auto other = static_cast<std::size_t>(found - b_scores.controllers.begin());
    CompareScores(name, a_scores.summary[c], b_scores.summary[other], result);
  }
  std::erase_if(result.scores, [&](const ScoreDifference& score) {
    return !a.scores.has_metric[score.metric] || !b.scores.has_metric[score.metric];
  });
  return result;
}

std::string_view ChangeText(ScoreChange change) {
  static constexpr std::string_view kTexts[] = {"same",      "better",    "worse",
                                                "only in A", "only in B", "of other joints"};
  return kTexts[static_cast<std::size_t>(change)];
}

double SizeOf(const ScoreDifference& score) {
  if (score.change == ScoreChange::kNone) return 0.0;
  const double size = std::abs(score.b - score.a) /
                      RelevantDifferenceBetween(Metrics()[score.metric], score.a, score.b);
  return std::isfinite(size) ? size : std::numeric_limits<double>::infinity();
}

ResultTable ScoreDifferences(const StudyDifference& difference, bool all, bool verbose) {
  ResultTable table{.columns = {{"controller", "controller"},
                                ResultColumn("metric", "score").Words(),
                                {"a", "A"},
                                {"b", "B"},
                                MeanColumn("difference", "B - A")},
                    .rows = {},
                    .names = verbose ? 2U : 1U};
  if (verbose) table.columns.push_back(ForPeople("95 % CI"));
  table.columns.push_back(ResultColumn("change", "B is").Words());
  for (const ScoreDifference& score : difference.scores) {
    if (score.change == ScoreChange::kNone && !all) continue;
    const MeanInterval& change = score.difference;
    ResultRow& row = table.rows.emplace_back();
    row = {ResultCell(score.controller),
           ResultCell({std::string(Metrics()[score.metric].key)}, ScoreName(score.metric)),
           ResultCell(score.a), ResultCell(score.b), CellOf(change)};
    row.back().text = std::isfinite(change.mean) ? fmt::format("{:+.3g}", change.mean) : "-";
    if (verbose) {
      row.push_back(ResultCell::Text(
          std::isfinite(change.low) ? fmt::format("{:+.3g} to {:+.3g}", change.low, change.high)
                                    : "-"));
    }
    row.emplace_back(std::string(ChangeText(score.change)));
    if (score.change != ScoreChange::kNone) {
      row.back().mark = score.change == ScoreChange::kBetter ? '*' : '!';
    }
  }
  return table;
}

Json StudyDifferenceJson(const StudyFolder& a, const StudyFolder& b,
                         const StudyDifference& difference) {
  constexpr const char* kMethods[] = {"paired", "unpaired", "plain"};
  Json json;
  json["same"] = difference.Same();
  json["a"] = FolderJson(a);
  json["b"] = FolderJson(b);
  json["settings"] = SettingsJson(difference.settings);
  json["versions"] = SettingsJson(difference.versions);
  json["controllers_only_in_a"] = difference.controllers_only_in_a;
  json["controllers_only_in_b"] = difference.controllers_only_in_b;
  json["channels_only_in_a"] = difference.channels_only_in_a;
  json["channels_only_in_b"] = difference.channels_only_in_b;
  json["metrics_only_in_a"] = difference.metrics_only_in_a;
  json["metrics_only_in_b"] = difference.metrics_only_in_b;
  json["method"] = kMethods[static_cast<int>(difference.method)];
  json["common_seeds"] = difference.common_seeds;
  json["scores"] = JsonOf(ScoreDifferences(difference, true, false));
  return json;
}

}  // namespace gauntlet::sim
