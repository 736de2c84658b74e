#include "sim/report/page_data.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>

#include "sim/report/curve_codec.h"
#include "sim/report/score_table.h"

namespace gauntlet::sim {
namespace {

using Json = nlohmann::ordered_json;

Json NumberOrNull(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

Json Estimates(const std::vector<MeanInterval>& estimates) {
  Json json = Json::array();
  for (const MeanInterval& estimate : estimates) {
    json.push_back({NumberOrNull(estimate.mean), NumberOrNull(estimate.ci95_low),
                    NumberOrNull(estimate.ci95_high), estimate.count});
  }
  return json;
}

Json Numbers(const std::vector<double>& values) {
  Json json = Json::array();
  for (const double value : values) json.push_back(NumberOrNull(value));
  return json;
}

Json MetricsJson() {
  const std::span<const std::string_view> main = MainMetrics();
  Json json = Json::array();
  for (const Metric& metric : Metrics()) {
    json.push_back({{"key", metric.key},
                    {"help", metric.help},
                    {"definition", metric.definition},
                    {"lower_is_better", metric.lower_is_better},
                    {"main", std::find(main.begin(), main.end(), metric.key) != main.end()}});
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

Json ControllerJson(const StudyResult& result, const Summary& summary, std::size_t index) {
  const ControllerSummary& controller = summary.controllers[index];
  Json json;
  json["name"] = controller.name;
  json["raw"] = summary.raw == static_cast<int>(index);
  json["dominated"] = static_cast<bool>(summary.dominated[index]);
  json["problem"] = controller.problem;
  json["untrusted_samples"] = UntrustedSamples(result, index);
  json["summary"] = Estimates(controller.summary);
  json["difference_to_raw"] = Estimates(controller.difference_to_raw);
  json["effect_size"] = Numbers(controller.effect_size);
  json["worse_than_raw"] = controller.worse_than_raw;
  json["rank"] = controller.rank;
  for (const std::vector<double>& channel : controller.channels) {
    json["channels"].push_back(Numbers(channel));
  }
  return json;
}

/// One channel of a signal in rad as a curve in degrees.
std::string Curve(const Signal& angle_rad, std::size_t channel, int samples_per_bucket) {
  const Eigen::VectorXd degrees = angle_rad.col(channel) * kDegPerRad;
  const std::span<const double> values(degrees.data(), degrees.size());
  return EncodeCurve(KeepPeaks(values, samples_per_bucket), kCurveStepDeg);
}

Json CurvesJson(const StudyResult& result, const std::vector<Signal>& command_angle_rad) {
  const Signal& truth = result.first_glove.true_angle_rad;
  const std::size_t controllers = result.first_traces.size();
  const std::size_t channels = result.channel_names.size();
  const std::int64_t curves = channels * (2 + 3 * controllers);
  const int bucket = SamplesPerBucket(truth.rows(), curves);
  Json json;
  json["samples"] = truth.rows();
  json["samples_per_bucket"] = bucket;
  json["step_deg"] = kCurveStepDeg;
  for (std::size_t c = 0; c < channels; ++c) {
    Json channel;
    channel["true"] = Curve(truth, c, bucket);
    // Before its filter every controller sees the same.
    channel["raw"] = Curve(result.first_traces.front().linearised_angle_rad, c, bucket);
    for (std::size_t i = 0; i < controllers; ++i) {
      channel["controllers"].push_back(
          {{"hand", Curve(result.first_traces[i].hand_angle_rad, c, bucket)},
           {"filtered", Curve(result.first_traces[i].filtered_angle_rad, c, bucket)},
           {"command", Curve(command_angle_rad[i], c, bucket)}});
    }
    json["channels"].push_back(std::move(channel));
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

}  // namespace

nlohmann::ordered_json PageData(const Scenario& scenario, const StudyResult& result,
                                const Summary& summary, const FirstSeed& first_seed,
                                bool comparison) {
  Json json;
  json["scenario"] = scenario.name;
  json["comparison"] = comparison && result.seeds.size() > 1;  // one seed has no interval
  for (const SeedOutcome& seed : result.seeds) json["seeds"].push_back(seed.seed);
  json["rate_hz"] = result.rate_hz;
  json["reference"] = result.reference_name;
  json["metrics"] = MetricsJson();
  for (std::size_t c = 0; c < summary.controllers.size(); ++c) {
    json["controllers"].push_back(ControllerJson(result, summary, c));
  }
  json["channels"] = result.channel_names;
  json["first_channel"] = scenario.video.channel;
  json["latency"] = LatencyJson(first_seed.latency);
  json["curves"] = nullptr;
  if (!first_seed.command_angle_rad.empty()) {
    json["curves"] = CurvesJson(result, first_seed.command_angle_rad);
  }
  return json;
}

}  // namespace gauntlet::sim
