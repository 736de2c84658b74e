#include "sim/answers/tune/tune_all.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "sim/answers/tune/filter_search.h"
#include "sim/answers/tune/tune_bench.h"
#include "sim/base/error.h"
#include "sim/study/scenario/scenario_reader.h"

namespace gauntlet::sim {
namespace {

constexpr std::array kFrontLevels = {0.7, 0.5, 0.35, 0.25};

/// The plan for one kind, without what is free.
TunePlan PlanOfKind(const TunePlan& plan, std::string_view kind) {
  TunePlan of_kind = plan;
  of_kind.prefers_low_jitter = false;  // kinds are compared by their least values
  of_kind.scenario.overrides.push_back(
      fmt::format("controllers.{}.filter={{kind: {}}}", plan.controller, kind));
  return of_kind;
}

/// The input of the controller's filter. Errors: UserError.
FilterInput InputOf(const Scenario& scenario, const controller::ControllerConfig& config) {
  const controller::Timing timing = TimingOf(scenario).controller;
  FilterInput input;
  input.rate_hz = config.filter_at == controller::FilterAt::kEvent ? timing.event_rate_hz()
                                                                   : timing.sample_rate_hz();
  if (config.filter_on == controller::FilterOn::kAngle) return input;
  const controller::GloveCalibration glove = NominalCalibration(scenario.glove);
  double sum = 0.0;
  for (std::size_t c = 0; c < glove.channel_names.size(); ++c) {
    sum += std::abs((glove.high_counts[c] - glove.low_counts[c]) /
                    (glove.high_angle_rad[c] - glove.low_angle_rad[c]));
  }
  input.unit_per_rad = sum / static_cast<double>(glove.channel_names.size());
  return input;
}

TunedKind TuneKind(const TunePlan& plan, std::string_view kind, int jobs,
                   const std::function<bool(double, double)>& progress) {
  TunedKind tuned{.kind = std::string(kind),
                  .left_out = {},
                  .plan = PlanOfKind(plan, kind),
                  .result = {},
                  .to_best = {}};
  Scenario scenario;
  try {
    scenario = ParseScenario(tuned.plan.scenario);
  } catch (const UserError& error) {  // as a Kalman filter of a glove without noise
    tuned.left_out = error.what();
    return tuned;
  }
  KeepControllers({plan.controller}, scenario);
  const controller::ControllerConfig& config = scenario.controllers.front().config;
  FilterSearch search = SearchOf(config.filters.front(), InputOf(scenario, config));
  tuned.left_out = search.left_out;
  if (!tuned.left_out.empty()) return tuned;
  for (SweepAxis& axis : search.free) {
    axis.key = fmt::format("controllers.{}.filter.{}", plan.controller, axis.key);
  }
  tuned.plan.free = std::move(search.free);
  tuned.result = SearchSettings(tuned.plan, jobs, progress);
  return tuned;
}

/// The jitter of the controller as the scenario has it. Errors: RunError if it does not run.
double JitterBefore(const TunePlan& plan, int jobs, const TuneBench::Progress& progress) {
  const std::vector<std::size_t> metrics = {plan.minimise, MetricIndex("jitter_rms_deg")};
  TunePlan unbound = plan;
  unbound.constraints.clear();
  const int first_seed = ParseScenario(plan.scenario).seed;
  const TunedSetting before =
      TuneBench(unbound, metrics, first_seed, plan.seeds, jobs).Run({}, progress);
  if (!before.problem.empty()) throw RunError(plan.controller + ": " + before.problem);
  return before.scores.back().mean;
}

void JudgeKinds(const TunePlan& plan, std::vector<TunedKind>& kinds) {
  std::ranges::stable_sort(kinds, [&plan](const TunedKind& a, const TunedKind& b) {
    const auto rank = [&plan](const TunedKind& tuned) {
      if (!tuned.has_answer()) return std::numeric_limits<double>::infinity();
      const double mean = tuned.result.verdict.scores.front().mean;
      return Metrics()[plan.minimise].lower_is_better ? mean : -mean;
    };
    return rank(a) < rank(b);
  });
  const auto count = static_cast<double>(std::ranges::count_if(kinds, &TunedKind::has_answer));
  if (count == 0.0) return;
  const TunedSetting& best = kinds.front().result.verdict;
  for (TunedKind& tuned : kinds) {
    if (!tuned.has_answer()) continue;
    tuned.to_best = ComparePaired(plan.minimise, tuned.result.verdict.minimised, best.minimised,
                                  best.motions, 0.5 * count * (count - 1.0));
  }
}

}  // namespace

std::vector<TunedKind> TuneAll(const TunePlan& plan, int jobs,
                               const std::function<bool(double done, double all)>& progress) {
  const auto kinds = controller::FilterKinds();
  const auto all = static_cast<double>(kinds.size());
  TunePlan of_all = plan;
  of_all.free.clear();
  of_all.front_jitter_deg.clear();
  const double jitter = JitterBefore(of_all, jobs, [&](double, int) { return progress(0.0, all); });
  if (std::isfinite(jitter)) {
    for (const double level : kFrontLevels) of_all.front_jitter_deg.push_back(level * jitter);
  }
  std::vector<TunedKind> tuned;
  for (const controller::FilterKind& kind : kinds) {
    const auto before = static_cast<double>(tuned.size());
    tuned.push_back(TuneKind(of_all, kind.name, jobs, [&](double done, double of) {
      return progress(before + done / of, all);
    }));
  }
  JudgeKinds(plan, tuned);
  return tuned;
}

}  // namespace gauntlet::sim
