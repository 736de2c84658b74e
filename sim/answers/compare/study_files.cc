#include "sim/answers/compare/study_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <type_traits>
#include <variant>

#include "sim/answers/compare/decisive_second.h"
#include "sim/base/csv_line.h"
#include "sim/base/json.h"
#include "sim/base/mathematics.h"
#include "sim/base/output_file.h"
#include "sim/score/statistics/result_cells.h"
#include "sim/study/counted_parts.h"
#include "sim/study/scenario/scenario_files.h"
#include "sim/trial/external/own_objects.h"
#include "sim/trial/trace_file.h"
#include "sim/trial/trace_signals.h"

namespace gauntlet::sim {
namespace {

/// Places in Metrics(). Those of links only where there are any.
std::vector<std::size_t> WrittenMetrics(const StudyResult& result) {
  const auto has_value = [&](std::size_t metric) {
    return std::ranges::any_of(result.seeds, [metric](const SeedOutcome& seed) {
      return std::ranges::any_of(seed.controllers, [metric](const TrialOutcome& trial) {
        return std::isfinite(trial.scores.summary[metric]);
      });
    });
  };
  std::vector<std::size_t> written;
  for (std::size_t m = 0; m < Metrics().size(); ++m) {
    if (!Metrics()[m].needs_link || has_value(m)) written.push_back(m);
  }
  return written;
}

/// Objects with a value per metric: {"delay_ms": .., ..}.
class JsonByMetric {
 public:
  explicit JsonByMetric(const StudyResult& result) : written_(WrittenMetrics(result)) {}

  Json Of(const auto& value_of) const {
    Json json = Json::object();
    for (const std::size_t m : written_) json[std::string(Metrics()[m].key)] = value_of(m);
    return json;
  }
  Json Of(const std::vector<double>& values) const {
    return Of([&](std::size_t m) { return NumberOrNull(values[m]); });
  }
  Json Of(const std::vector<Comparison>& comparisons, const std::string& replicates) const {
    return Of([&](std::size_t m) { return JsonOf(comparisons[m], replicates); });
  }
  /// The scores that a row has: those of its joint, motor or cable.
  Json OfRow(const ScoreRows& rows, std::size_t row, const std::vector<double>& values) const;
  Json Of(const std::vector<MeanInterval>& estimates, const std::string& replicates) const;

 private:
  std::vector<std::size_t> written_;
};

Json JsonByMetric::OfRow(const ScoreRows& rows, std::size_t row,
                         const std::vector<double>& values) const {
  const std::vector<std::size_t> none;
  const std::array rows_of_part = {&rows.joints, &rows.motors, &rows.cables, &none};
  Json json = Json::object();
  for (const std::size_t m : written_) {
    const auto& scored = *rows_of_part[static_cast<std::size_t>(Metrics()[m].part)];
    if (std::ranges::find(scored, row) == scored.end()) continue;
    json[std::string(Metrics()[m].key)] = NumberOrNull(values[m]);
  }
  return json;
}

Json EstimateJson(const MeanInterval& estimate, const std::string& replicates = "seeds") {
  Json json = JsonOf(estimate);
  json[replicates] = estimate.count;
  return json;
}

Json JsonByMetric::Of(const std::vector<MeanInterval>& estimates,
                      const std::string& replicates) const {
  return Of([&](std::size_t m) {
    Json json = EstimateJson(estimates[m], replicates);
    json["motion_share"] = NumberOrNull(estimates[m].motion_share);
    return json;
  });
}

/// Times in s, from the begin of the trial.
Json BlocksJson(const RecordingBlocks& blocks) {
  Json json = {{"counted_s", blocks.duration_s},
               {"correlation_s", blocks.plan.correlation_s},
               {"needed_s", blocks.plan.needed_s},
               {"replicates", Json::array()}};
  for (const RecordingBlock& block : blocks.blocks) {
    json["replicates"].push_back({{"start_s", block.start_s}, {"end_s", block.end_s}});
  }
  return json;
}

/// Trials with one cause of the error switched off: the number of seeds, the seconds of the motion
/// and the controllers; null where there are none.
Json CausesJson(const Summary& summary) {
  const CausePlan& plan = summary.causes;
  if (!plan.switched) return nullptr;
  Json json = {{"seeds", plan.seeds}, {"first_s", nullptr}, {"controllers", Json::array()}};
  if (plan.stretch_s) json["first_s"] = *plan.stretch_s;
  for (std::size_t c = 0; c < summary.controllers.size(); ++c) {
    if (std::isfinite(summary.controllers[c].summary[ErrorWithAll()].mean)) {
      json["controllers"].push_back(summary.controllers[c].name);
    }
  }
  return json;
}

Json ControllerJson(const FinishedStudy& finished, std::size_t index) {
  const StudyResult& result = finished.result;
  const ControllerSummary& controller = finished.summary.controllers[index];
  const bool comparison = finished.comparison;
  const std::string replicates = ReplicatesOf(finished.summary);
  const JsonByMetric by_metric(result);
  Json json;
  json["name"] = controller.name;
  json["role"] = finished.summary.answer.roles[index];
  json["health"] = controller.problem.empty() ? "ok" : controller.problem;
  json["failed_trials"] = controller.failed_trials;
  json["summary"] = comparison ? by_metric.Of(controller.summary, replicates)
                               : by_metric.Of(result.seeds[0].controllers[index].scores.summary);
  if (comparison && !controller.to_baseline.empty()) {
    json["difference_to_baseline"] = by_metric.Of(controller.to_baseline, replicates);
    json["effect_size"] = by_metric.Of(controller.effect_size);
  }
  for (std::size_t row = 0; row < result.row_names.size(); ++row) {
    json["channels"][result.row_names[row]] =
        by_metric.OfRow(finished.study.rows, row, controller.rows[row]);
  }
  if (!finished.summary.blocks.empty()) {
    const auto& values = finished.summary.blocks.values[index];
    for (std::size_t m = 0; m < values.size(); ++m) {
      if (!values[m].empty()) json["blocks"][std::string(Metrics()[m].key)] = values[m];
    }
  }
  return json;
}

}  // namespace

std::string ReplicatesOf(const Summary& summary) {
  return summary.blocks.empty() ? "seeds" : "blocks";
}

Json JsonOf(const Comparison& comparison, const std::string& replicates) {
  const auto& [difference, relevant_difference, judgement] = comparison;
  const bool judged = judgement != Judgement::kNone;
  return {{"mean", NumberOrNull(difference.mean)},
          {"low", NumberOrNull(difference.low)},
          {"high", NumberOrNull(difference.high)},
          {"level", judged ? Json(difference.level) : Json(nullptr)},
          {"relevant_difference", NumberOrNull(relevant_difference)},
          {"verdict", judged ? Json(JudgementText(judgement)) : Json(nullptr)},
          {replicates, difference.count},
          {"motion_share", NumberOrNull(difference.motion_share)}};
}

std::string ScoresJson(const FinishedStudy& finished) {
  const StudyResult& result = finished.result;
  const Summary& summary = finished.summary;
  Json json;
  json["scenario"] = finished.study.scenario.name;
  json["question"] = finished.study.scenario.question;
  if (finished.comparison) {
    for (const SeedOutcome& seed : result.seeds) json["seeds"].push_back(seed.seed);
    for (const SeedOutcome& seed : result.seeds) json["motions"].push_back(seed.motion);
    json["seeds_alike"] = result.seeds_alike;
    json["pairs"] = summary.pairs;
    json["primary_pairs"] = summary.primary_pairs;
    if (summary.blocks.is_wanted) json["blocks"] = BlocksJson(summary.blocks);
  } else {
    json["seed"] = result.seeds[0].seed;
  }
  json["reference"] = result.reference_name;
  json["baseline"] = nullptr;
  if (summary.baseline) json["baseline"] = summary.controllers[*summary.baseline].name;
  json["verdict"] = JsonOf(summary.answer.verdict);
  const auto names_of = [&](const std::vector<std::size_t>& places) {
    Json names = Json::array();
    for (const std::size_t c : places) names.push_back(summary.controllers[c].name);
    return names;
  };
  json["order"] = names_of(summary.answer.order);
  json["shown"] = names_of(summary.answer.shown);
  json["decisive_second"] = nullptr;
  if (const auto second = DecisiveSecondOf(finished)) {
    json["decisive_second"] = {
        {"from_s", second->from_s}, {"to_s", second->to_s}, {"moment_s", second->moment_s}};
  }
  json["measured_joints"] = finished.study.measured_joint_names;
  json["causes"] = CausesJson(summary);
  const std::vector<double> counted_shares = CountedShares(finished.study);
  if (std::ranges::any_of(counted_shares, [](double share) { return share < 1.0; })) {
    for (std::size_t i = 0; i < counted_shares.size(); ++i) {
      json["counted_share"][finished.study.measured_joint_names[i]] = counted_shares[i];
    }
  }
  for (const SmoothingRank& rank : finished.smoothing) {
    Json row;
    row["smoothing_hz"] = rank.smoothing_hz;
    for (std::size_t c = 0; c < rank.tracking_rmse_deg.size(); ++c) {
      row["tracking_rmse_deg"][result.controller_names[c]] =
          NumberOrNull(rank.tracking_rmse_deg[c]);
    }
    json["smoothing"].push_back(row);
  }
  for (std::size_t c = 0; c < summary.controllers.size(); ++c) {
    json["controllers"].push_back(ControllerJson(finished, c));
  }
  return json.dump(2) + "\n";
}

std::string ScoresCsv(const StudyResult& result) {
  std::vector<std::string> head = {"seed", "controller", "channel"};
  const std::vector<std::size_t> written = WrittenMetrics(result);
  for (const std::size_t m : written) head.emplace_back(Metrics()[m].key);
  std::string csv = CsvLine(head);
  for (const SeedOutcome& seed : result.seeds) {
    for (std::size_t c = 0; c < seed.controllers.size(); ++c) {
      const auto add = [&](const std::string& channel, const std::vector<double>& values) {
        std::vector<std::string> row = {fmt::to_string(seed.seed), result.controller_names[c],
                                        channel};
        std::ranges::transform(written, std::back_inserter(row),
                               [&](std::size_t m) { return NumberOrNothing(values[m]); });
        csv += CsvLine(row);
      };
      const Scores& scores = seed.controllers[c].scores;
      add("summary", scores.summary);
      for (std::size_t i = 0; i < scores.channels.size(); ++i) {
        add(result.row_names[i], scores.channels[i]);
      }
    }
  }
  return csv;
}

std::string ResolvedScenario(const FinishedStudy& finished) {
  Scenario scenario = finished.study.scenario;
  scenario.made_with = {.gauntlet_version = GAUNTLET_VERSION,
                        .mujoco_version = HandModel::EngineVersion(),
                        .model_hash = finished.study.hand->Hash(),
                        .mathematics = HashOfMathematics(),
                        .files = FilesOf(scenario)};
  std::string notes;
  for (const std::string& note : finished.study.hand->notes()) notes += "# " + note + "\n";
  bool has_programs = false, has_objects = false;
  for (const NamedController& named : scenario.controllers) {
    for (const controller::FilterConfig& filter : named.config.filters) {
      const auto* external = std::get_if<controller::ExternalConfig>(&filter.settings);
      if (external == nullptr || !external->answers.empty()) continue;
      (NamesObject(*external) ? has_objects : has_programs) = true;
    }
  }
  if (has_programs) {
    notes +=
        "# It repeats only with the programs of its filters: their files are below made_with.\n";
  }
  if (has_objects) {
    notes +=
        "# It repeats only from Python, with the objects that its filters (command: python:..) "
        "name.\n";
  }
  return notes + ScenarioToYaml(scenario, finished.folder);
}

namespace {

/// Files that need the signals of all controllers together: before WriteTraces().
void WriteScores(const std::filesystem::path& folder, const FinishedStudy& finished) {
  WriteOutputFile(folder / "scenario.resolved.yaml", ResolvedScenario(finished));
  WriteOutputFile(folder / "scores.csv", ScoresCsv(finished.result));
  WriteOutputFile(folder / "scores.json", ScoresJson(finished));
}

/// `is_written` gets the number of each controller whose signals no other file needs.
template <class IsWritten>
void WriteTraces(const std::filesystem::path& folder, const FinishedStudy& finished,
                 const TraceFormats& formats, const IsWritten& is_written) {
  const HandModel& hand = *finished.study.hand;
  const StudyResult& result = finished.result;
  if (result.first_traces.empty()) return;
  if (formats.mcap) {
    WriteTraceMcap(folder / "trace.mcap", *result.first_glove, result.first_reference_rad, hand,
                   result.first_traces);
  }
  TraceWriter trace_file(folder / "trace.h5", *result.first_glove, result.first_reference_rad, hand,
                         finished.study.scenario.name, result.seeds[0].seed);
  for (std::size_t c = 0; c < result.first_traces.size(); ++c) {
    const Trace& trace = result.first_traces[c];
    trace_file.Add(trace, result.first_twins[c] ? &*result.first_twins[c] : nullptr,
                   result.first_others[c]);
    if (formats.csv) {
      WriteTraceCsv(folder / fmt::format("trace.{}.csv", trace.controller_name),
                    *result.first_glove, hand, trace);
    }
    is_written(c);
  }
  trace_file.Commit();
}

}  // namespace

void WriteStudyFiles(const std::filesystem::path& folder, const FinishedStudy& finished,
                     const TraceFormats& formats) {
  WriteScores(folder, finished);
  WriteTraces(folder, finished, formats, [](std::size_t) {});
}

void WriteLastStudyFiles(const std::filesystem::path& folder, FinishedStudy& finished,
                         const TraceFormats& formats) {
  WriteScores(folder, finished);
  StudyResult& result = finished.result;
  WriteTraces(folder, finished, formats, [&result](std::size_t controller) {
    ForEachSignal(result.first_traces[controller],
                  [](const auto&, auto& matrix) { matrix = std::decay_t<decltype(matrix)>(); });
    result.first_twins[controller].reset();
    result.first_others[controller] = {};
  });
}

}  // namespace gauntlet::sim
