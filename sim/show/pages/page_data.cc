#include "sim/show/pages/page_data.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>

#include "sim/answers/compare/comparison_verdict.h"
#include "sim/answers/compare/decisive_second.h"
#include "sim/answers/compare/study_files.h"
#include "sim/base/json.h"
#include "sim/score/statistics/result_cells.h"
#include "sim/show/figure/palette.h"
#include "sim/show/pages/curve_codec.h"
#include "sim/show/pages/error_split_table.h"
#include "sim/show/pages/replay_data.h"
#include "sim/show/pages/score_table.h"

namespace gauntlet::sim {
namespace {

Json Estimates(const std::vector<MeanInterval>& estimates) {
  Json json = Json::array();
  for (const MeanInterval& estimate : estimates) {
    json.push_back({NumberOrNull(estimate.mean), NumberOrNull(estimate.low),
                    NumberOrNull(estimate.high), estimate.count});
  }
  return json;
}

/// Differences to the baseline, with the intervals that people get.
Json ComparisonsJson(const ControllerSummary& controller) {
  Json json = Json::array();
  for (std::size_t m = 0; m < controller.to_baseline.size(); ++m) {
    Comparison shown = controller.to_baseline[m];
    shown.difference = ShownInterval(shown.difference, controller.summary[m].mean);
    json.push_back(JsonOf(shown, "replicates"));
  }
  return json;
}

Json Numbers(const std::vector<double>& values) {
  Json json = Json::array();
  for (const double value : values) json.push_back(NumberOrNull(value));
  return json;
}

Json MetricsJson() {
  Json json = Json::array();
  for (const Metric& metric : Metrics()) {
    json.push_back({{"key", metric.key},
                    {"help", metric.help},
                    {"definition", metric.definition},
                    {"lower_is_better", metric.lower_is_better},
                    {"main", metric.main},
                    {"relevant_reason", metric.relevant_difference.reason}});
  }
  return json;
}

std::int64_t UntrustedSamples(const StudyResult& result, std::size_t controller) {
  std::int64_t count = 0;
  for (const SeedOutcome& seed : result.seeds) {
    const auto& samples = seed.controllers[controller].untrusted_samples;
    count = std::accumulate(samples.begin(), samples.end(), count);
  }
  return count;
}

Json ControllerJson(const StudyResult& result, const Summary& summary, std::size_t index,
                    std::size_t series) {
  const ControllerSummary& controller = summary.controllers[index];
  Json json;
  json["name"] = controller.name;
  json["colour"] = CssOfSeries(series);
  json["baseline"] = summary.baseline == index;
  json["failed_trials"] = controller.failed_trials;
  json["problem"] = controller.problem;
  json["untrusted_samples"] = UntrustedSamples(result, index);
  json["summary"] = Estimates(controller.summary);
  std::string marks;  // one per metric
  for (std::size_t m = 0; m < Metrics().size(); ++m) marks += summary.MarkOf(index, m);
  json["marks"] = marks;
  json["to_baseline"] = ComparisonsJson(controller);
  json["effect_size"] = Numbers(controller.effect_size);
  for (const std::vector<double>& row : controller.rows) json["rows"].push_back(Numbers(row));
  return json;
}

/// The joints of a signal in rad as curves in degrees.
FirstSeed::Curves CurvesOf(const Signal& angle_rad, int samples_per_bucket) {
  FirstSeed::Curves curves;
  for (Eigen::Index joint = 0; joint < angle_rad.cols(); ++joint) {
    const Eigen::VectorXd degrees = angle_rad.col(joint) * kDegPerRad;
    const std::span<const double> values(degrees.data(), static_cast<std::size_t>(degrees.size()));
    curves.push_back(EncodeCurve(KeepPeaks(values, samples_per_bucket), kCurveStepDeg));
    TrimSignals();
  }
  return curves;
}

Json CurvesJson(const FirstSeed& first_seed) {
  Json json;
  json["samples"] = first_seed.samples;
  json["samples_per_bucket"] = first_seed.samples_per_bucket;
  json["step_deg"] = kCurveStepDeg;
  for (std::size_t j = 0; j < first_seed.reference.size(); ++j) {
    Json joint;
    joint["true"] = first_seed.reference[j];
    joint["raw"] = first_seed.raw[j];
    for (const FirstSeed::ControllerCurves& controller : first_seed.controllers) {
      joint["controllers"].push_back({{"hand", controller.hand[j]},
                                      {"filtered", controller.filtered[j]},
                                      {"command", controller.command[j]}});
    }
    json["channels"].push_back(std::move(joint));
  }
  return json;
}

/// Null where no controller has a latency, else stages with a value per controller.
Json LatencyJson(const std::vector<std::optional<LatencyBudget>>& budgets) {
  const auto any = std::find_if(budgets.begin(), budgets.end(),
                                [](const auto& budget) { return budget.has_value(); });
  if (any == budgets.end()) return nullptr;
  Json json;
  for (std::size_t s = 0; s < (*any)->stages.size(); ++s) {
    Json values = Json::array();
    for (const auto& budget : budgets) {
      values.push_back(budget ? NumberOrNull(budget->stages[s].mean_ms) : Json(nullptr));
    }
    json["stages"].push_back({{"help", (*any)->stages[s].help}, {"ms", values}});
  }
  for (const auto& budget : budgets) {
    json["sum_ms"].push_back(budget ? NumberOrNull(budget->sum_ms) : Json(nullptr));
    json["total_ms"].push_back(budget ? NumberOrNull(budget->total_ms) : Json(nullptr));
  }
  return json;
}

/// The main scores of every seed, per controller: what means and intervals are made of.
Json ScoresBySeed(const StudyResult& result, const Summary& summary) {
  Json json = Json::object();
  for (const std::size_t metric : ShownMetrics(summary)) {
    Json& controllers = json[std::string(Metrics()[metric].key)];
    for (std::size_t c = 0; c < result.controller_names.size(); ++c) {
      controllers.push_back(Numbers(SeedValues(result, c, metric)));
    }
  }
  return json;
}

/// Null where no controller has a split, else its causes, the numbers of their colours, and their
/// mean squares per controller.
Json ErrorSplitJson(const Summary& summary) {
  Json json;
  bool any = false;
  const std::vector<std::size_t> shown = ShownCauses(summary);
  for (const std::size_t cause : shown) json["parts"].push_back(TrackingErrorParts()[cause].name);
  json["colours"] = shown;
  for (const ControllerSummary& controller : summary.controllers) {
    const std::vector<double> parts = ErrorByCause(controller);
    Json& values = json["controllers"].emplace_back(nullptr);
    if (parts.empty()) continue;
    for (const std::size_t cause : shown) values.push_back(parts[cause]);
    any = true;
  }
  return any ? json : Json(nullptr);
}

/// Null where no cause was switched off alone, else the errors without each, and those with all
/// causes, per controller.
Json SwitchedJson(const Summary& summary) {
  const bool any = std::ranges::any_of(summary.controllers, [](const ControllerSummary& one) {
    return std::isfinite(one.summary[ErrorWithAll()].mean);
  });
  if (!any) return nullptr;
  Json json = {{"part", PartOfCauses(summary)}, {"names", {"with all causes"}}};
  std::vector<std::size_t> metrics = {ErrorWithAll()};
  for (const CauseMetric& error : SwitchedErrors()) {
    json["names"].push_back(fmt::format("without {}", error.name));
    metrics.push_back(error.metric);
  }
  for (const ControllerSummary& controller : summary.controllers) {
    Json& values = json["controllers"].emplace_back(Json::array());
    Json& margins = json["margins"].emplace_back(Json::array());
    for (const std::size_t metric : metrics) {
      const MeanInterval& value = controller.summary[metric];
      values.push_back(NumberOrNull(value.mean));
      margins.push_back(NumberOrNull(ShownInterval(value, value.mean).high - value.mean));
    }
  }
  return json;
}

/// Per joint where the first seed does not count: [from, to] in seconds; null where all does.
Json UncountedJson(const FinishedStudy& finished, const FirstSeed& first_seed) {
  if (!first_seed.counted) return nullptr;
  const double rate_hz = finished.result.first_glove->tick_rate_hz;
  Json joints = Json::array();
  for (const CountedTicks& counted : first_seed.counted->joints) {
    Json stretches = Json::array();
    std::int64_t begin = 0;
    const auto add = [&](std::int64_t end) {
      if (end <= begin) return;
      stretches.push_back(
          {static_cast<double>(begin) / rate_hz, static_cast<double>(end) / rate_hz});
    };
    for (const TickRange& range : counted) {
      add(range.begin);
      begin = range.end;
    }
    add(first_seed.samples);
    joints.push_back(stretches);
  }
  return joints;
}

}  // namespace

FirstSeed::FirstSeed(const Signal& reference_rad, std::size_t controller_count)
    : samples(reference_rad.rows()),
      samples_per_bucket(SamplesPerBucket(
          samples, reference_rad.cols() * static_cast<std::int64_t>(2 + 3 * controller_count))),
      reference(CurvesOf(reference_rad, samples_per_bucket)) {}

void FirstSeed::Add(const WayOfAngles& way, const Signal& hand_rad) {
  if (controllers.empty()) raw = CurvesOf(way.raw, samples_per_bucket);
  controllers.push_back({.hand = CurvesOf(hand_rad, samples_per_bucket),
                         .filtered = CurvesOf(way.filtered, samples_per_bucket),
                         .command = CurvesOf(way.command, samples_per_bucket)});
}

Json PageData(const FinishedStudy& finished, const FirstSeed& first_seed) {
  const StudyResult& result = finished.result;
  const Summary& summary = finished.summary;
  Json json;
  json["scenario"] = finished.study.scenario.name;
  json["comparison"] = !summary.one_run;
  json["blocks"] = summary.blocks.Text();
  for (const SeedOutcome& seed : result.seeds) json["seeds"].push_back(seed.seed);
  json["rate_hz"] = result.first_glove->tick_rate_hz;
  json["reference"] = result.reference_name;
  json["metrics"] = MetricsJson();
  json["notes"] = Notes(finished);
  json["legend"] = MarkLegend(summary);
  json["failures"] = Failures(summary, result.seeds.size());
  const std::vector<std::size_t>& order = summary.answer.order;
  const std::vector<std::size_t> series = SeriesOf(order, summary.baseline);
  for (std::size_t c = 0; c < summary.controllers.size(); ++c) {
    json["controllers"].push_back(ControllerJson(result, summary, c, series[c]));
  }
  json["order"] = order;
  json["by_seed"] = ScoresBySeed(result, summary);
  json["baseline"] = nullptr;
  if (summary.baseline) json["baseline"] = summary.controllers[*summary.baseline].name;
  json["rows"] = result.row_names;
  json["channels"] = finished.study.measured_joint_names;
  json["first_channel"] = finished.study.scenario.video.channel;
  json["switched"] = SwitchedJson(summary);
  json["error_split"] = ErrorSplitJson(summary);
  json["latency"] = LatencyJson(first_seed.latency);
  json["curves"] = nullptr;
  if (!first_seed.controllers.empty()) json["curves"] = CurvesJson(first_seed);
  json["uncounted_s"] = UncountedJson(finished, first_seed);
  json["replay"] = ReplayData(finished);
  json["shown"] = summary.answer.shown;
  json["decisive_second"] = nullptr;
  if (const auto second = DecisiveSecondOf(finished)) {
    json["decisive_second"] = {second->from_s, second->to_s, second->moment_s};
  }
  return json;
}

}  // namespace gauntlet::sim
