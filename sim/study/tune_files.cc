#include "sim/study/tune_files.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "sim/base/csv_line.h"
#include "sim/base/data_folder.h"
#include "sim/settings/yaml_writer.h"

namespace gauntlet::sim {
namespace {

nlohmann::ordered_json IntervalJson(const MeanInterval& interval) {
  const auto number = [](double value) {
    return std::isfinite(value) ? nlohmann::ordered_json(value) : nlohmann::ordered_json(nullptr);
  };
  return {{"mean", number(interval.mean)},
          {"ci95_low", number(interval.low)},
          {"ci95_high", number(interval.high)}};
}

nlohmann::ordered_json SettingJson(const TunePlan& plan, const TuneResult& result,
                                   const TunedSetting& setting) {
  nlohmann::ordered_json json;
  for (std::size_t a = 0; a < setting.values.size(); ++a) {
    json["settings"][plan.free[a].key] = setting.values[a];
  }
  for (std::size_t m = 0; m < result.metrics.size(); ++m) {
    json["scores"][std::string(Metrics()[result.metrics[m]].key)] = IntervalJson(setting.scores[m]);
  }
  json["constraints_met"] = MetText(setting.met);
  if (!setting.problem.empty()) json["problem"] = setting.problem;
  return json;
}

/// What is known of each setting that was tried: its scores with intervals, and the rest.
void AddScoreNames(const std::vector<std::size_t>& metrics, std::vector<std::string>& head) {
  for (const std::size_t metric : metrics) {
    for (const char* ending : {"", "_low", "_high"}) {
      head.push_back(std::string(Metrics()[metric].key) + ending);
    }
  }
  head.insert(head.end(), {"constraints_met", "problem"});
}
void AddScores(const TunedSetting& setting, std::vector<std::string>& row) {
  for (const MeanInterval& score : setting.scores) {
    for (const double value : {score.mean, score.low, score.high}) {
      row.push_back(NumberOrNothing(value));
    }
  }
  row.emplace_back(MetText(setting.met));
  row.push_back(setting.problem);
}

/// What was asked and found of one controller.
nlohmann::ordered_json ResultJson(const TunePlan& plan, const TuneResult& result) {
  nlohmann::ordered_json json;
  json["tried"] = result.tried.size();
  if (!result.problem.empty()) {
    json["problem"] = result.problem;
  } else {
    json["tuned"] = SettingJson(plan, result, result.verdict);
    json["before"] = SettingJson(plan, result, result.before);
    json["gain"] = IntervalJson(result.gain.difference);
    json["gain"]["verdict"] = JudgementText(result.gain.judgement);
    for (std::size_t a = 0; a < plan.free.size(); ++a) {
      json["as_good"][plan.free[a].key] = {result.equal[a].low, result.equal[a].high};
    }
  }
  for (const std::size_t i : result.front) {
    json["front"].push_back(SettingJson(plan, result, result.tried[i]));
  }
  return json;
}

nlohmann::ordered_json AskedJson(const TunePlan& plan) {
  nlohmann::ordered_json json;
  json["scenario"] = PathFrom(std::filesystem::current_path(), plan.scenario.file);
  json["controller"] = plan.controller;
  json["minimise"] = Metrics()[plan.minimise].key;
  json["physics"] = plan.physics;
  json["seeds"] = plan.seeds;
  json["held_out_seeds"] = plan.held_out;
  return json;
}

}  // namespace

std::string ControllerYaml(const NamedController& controller) {
  NamedController copy = controller;  // a visitor may change what it sees
  return SettingsToYaml([&copy](controller::SettingsVisitor& visitor) { copy.Visit(visitor); });
}

std::string TuneCsv(const TunePlan& plan, const TuneResult& result) {
  std::vector<std::string> head;
  for (const SweepAxis& axis : plan.free) head.push_back(axis.key);
  AddScoreNames(result.metrics, head);
  std::string text = CsvLine(head);
  for (const TunedSetting& setting : result.tried) {
    std::vector<std::string> row = setting.values;
    AddScores(setting, row);
    text += CsvLine(row);
  }
  return text;
}

std::string TuneJson(const TunePlan& plan, const TuneResult& result) {
  nlohmann::ordered_json json = AskedJson(plan);
  json.update(ResultJson(plan, result));
  return json.dump(1) + "\n";
}

std::string TuneAllCsv(const std::vector<TunedKind>& kinds) {
  std::vector<std::string> head = {"filter", "settings", "front"};
  AddScoreNames(kinds.front().result.metrics, head);
  std::string text = CsvLine(head);
  for (const TunedKind& tuned : kinds) {
    for (std::size_t i = 0; i < tuned.result.tried.size(); ++i) {
      const TunedSetting& setting = tuned.result.tried[i];
      const bool is_front = std::ranges::count(tuned.result.front, i) > 0;
      std::vector<std::string> row = {tuned.kind, SettingsText(tuned.plan, setting.values),
                                      is_front ? "1" : "0"};
      AddScores(setting, row);
      text += CsvLine(row);
    }
  }
  return text;
}

std::string TuneAllJson(const TunePlan& plan, const std::vector<TunedKind>& kinds) {
  nlohmann::ordered_json json = AskedJson(plan);
  json["filters"] = nlohmann::ordered_json::array();
  for (const TunedKind& tuned : kinds) {
    nlohmann::ordered_json& entry = json["filters"].emplace_back();
    entry["filter"] = tuned.kind;
    if (!tuned.left_out.empty()) {
      entry["left_out"] = tuned.left_out;
      continue;
    }
    if (tuned.has_answer()) {
      entry["to_best"] = IntervalJson(tuned.to_best.difference);
      entry["to_best"]["verdict"] = JudgementText(tuned.to_best.judgement);
    }
    entry.update(ResultJson(tuned.plan, tuned.result));
  }
  return json.dump(1) + "\n";
}

}  // namespace gauntlet::sim
