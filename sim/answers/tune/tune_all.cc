#include "sim/answers/tune/tune_all.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <optional>
#include <span>

#include "sim/answers/tune/filter_search.h"
#include "sim/answers/tune/tune_bench.h"
#include "sim/answers/tune/tune_memo.h"
#include "sim/base/error.h"
#include "sim/base/stop.h"
#include "sim/study/scenario/scenario_reader.h"

namespace gauntlet::sim {

TunePlan PlanOfForm(const TunePlan& plan, const FilterForm& form) {
  TunePlan of_kind = plan;
  of_kind.prefers_low_jitter = false;  // kinds are compared by their least values
  of_kind.scenario.overrides.push_back(fmt::format("controllers.{}.filter={{kind: {}{}{}}}",
                                                   plan.controller, form.kind,
                                                   form.fixed.empty() ? "" : ", ", form.fixed));
  return of_kind;
}

namespace {

constexpr std::array kFrontLevels = {0.7, 0.5, 0.35, 0.25};

TunedKind TuneForm(const TunePlan& plan, const TuneSplit& split, const FilterForm& form, int jobs,
                   const std::function<bool(double, double)>& progress) {
  TunedKind tuned{.kind = std::string(form.kind),
                  .left_out = {},
                  .plan = PlanOfForm(plan, form),
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
  tuned.result = SearchSettings(tuned.plan, split, jobs, progress);
  return tuned;
}

/// The jitter of the controller as the scenario has it. Errors: RunError if it does not run.
double JitterBefore(const TunePlan& plan, const TuneSplit& split, int jobs,
                    const TuneBench::Progress& progress) {
  const std::vector<std::size_t> metrics = {plan.minimise, MetricIndex("jitter_rms_deg")};
  TunePlan unbound = plan;
  unbound.constraints.clear();
  const TunedSetting before =
      TuneBench(unbound, metrics, split, TunePart::kFitted, jobs).Run({}, progress);
  if (!before.problem.empty()) throw RunError(plan.controller + ": " + before.problem);
  return before.scores.back().mean;
}

/// The answer of a kind on the fitted part.
const TunedSetting& FittedOf(const TunedKind& tuned) {
  return tuned.result.tried[tuned.result.chosen];
}

/// The kind to choose by the fitted part, among the first `count`, which have an answer.
std::size_t ChosenOf(const TunePlan& plan, const std::vector<TunedKind>& kinds, std::size_t count) {
  const double sign = Metrics()[plan.minimise].lower_is_better ? 1.0 : -1.0;
  std::size_t best = 0;
  for (std::size_t i = 1; i < count; ++i) {
    const auto of = [&](std::size_t k) { return sign * FittedOf(kinds[k]).scores.front().mean; };
    if (of(i) < of(best)) best = i;
  }
  const double pairs = PairsOf(static_cast<double>(count));
  const auto jitter_of = [&](std::size_t k) {
    const std::size_t place = PlaceOfMetric(kinds[k].result.metrics, MetricIndex("jitter_rms_deg"));
    return FittedOf(kinds[k]).scores[place].mean;
  };
  std::size_t chosen = best;
  for (std::size_t i = 0; i < count; ++i) {
    const Comparison to_best =
        ComparePaired(plan.minimise, FittedOf(kinds[i]).minimised, FittedOf(kinds[best]).minimised,
                      FittedOf(kinds[best]).motions, pairs);
    const bool is_equal = i == best || to_best.judgement == Judgement::kEqual;
    if (is_equal && jitter_of(i) < jitter_of(chosen)) chosen = i;
  }
  return chosen;
}

void JudgeKinds(const TunePlan& plan, std::vector<TunedKind>& kinds) {
  std::stable_partition(kinds.begin(), kinds.end(),
                        [](const TunedKind& tuned) { return tuned.has_answer(); });
  const auto count = static_cast<std::size_t>(std::ranges::count_if(kinds, &TunedKind::has_answer));
  if (count == 0) return;
  const auto begin = kinds.begin();
  const auto chosen = begin + static_cast<std::ptrdiff_t>(ChosenOf(plan, kinds, count));
  std::rotate(begin, chosen, chosen + 1);
  const double sign = Metrics()[plan.minimise].lower_is_better ? 1.0 : -1.0;
  std::stable_sort(begin + 1, begin + static_cast<std::ptrdiff_t>(count),
                   [sign](const TunedKind& a, const TunedKind& b) {
                     return sign * a.result.verdict.scores.front().mean <
                            sign * b.result.verdict.scores.front().mean;
                   });
  const TunedSetting& best = kinds.front().result.verdict;
  for (std::size_t i = 0; i < count; ++i) {
    const TunedSetting& held_out = kinds[i].result.verdict;
    kinds[i].to_best = ComparePaired(plan.minimise, held_out.minimised, best.minimised,
                                     best.motions, static_cast<double>(count - 1));
  }
  kinds.front().to_best.judgement = Judgement::kEqual;
}

}  // namespace

namespace {

/// Searches some kinds, in their order.
std::vector<TunedKind> SearchKinds(const TunePlan& plan,
                                   std::span<const controller::FilterKind> kinds, int jobs,
                                   const std::function<bool(double done, double all)>& progress) {
  const auto all = static_cast<double>(kinds.size());
  TunePlan of_all = plan;
  of_all.free.clear();
  of_all.front_jitter_deg.clear();
  const TuneSplit split = SplitOf(of_all, jobs);
  const double jitter =
      JitterBefore(of_all, split, jobs, [&](double, int) { return progress(0.0, all); });
  if (std::isfinite(jitter)) {
    for (const double level : kFrontLevels) of_all.front_jitter_deg.push_back(level * jitter);
  }
  std::vector<TunedKind> tuned;
  for (const controller::FilterKind& kind : kinds) {
    const auto before = static_cast<double>(tuned.size());
    tuned.push_back(TuneForm(of_all, split, {.kind = kind.name}, jobs, [&](double done, double of) {
      return progress(before + done / of, all);
    }));
  }
  return tuned;
}

}  // namespace

std::vector<TunedKind> TuneAll(const TunePlan& plan, int jobs,
                               const std::function<bool(double done, double all)>& progress) {
  std::vector<TunedKind> tuned = SearchKinds(plan, controller::FilterKinds(), jobs, progress);
  JudgeKinds(plan, tuned);
  return tuned;
}

NearestFilter TuneNearest(const TunePlan& plan, std::span<const FilterForm> forms, int jobs,
                          const std::function<void(double seconds)>& expect,
                          const std::function<bool(double done, double all)>& progress) {
  using Clock = std::chrono::steady_clock;
  constexpr double kAsMuchJitter = 1.05;
  const TuneSplit split = SplitOf(plan, jobs);
  const auto all = static_cast<double>(forms.size());
  const TuneBench::Progress first = [&](double, int) { return progress(0.0, all); };
  TunePlan bound = plan;
  if (const double jitter = JitterBefore(plan, split, jobs, first); jitter > 0.0) {
    bound.constraints = {
        {.metric = MetricIndex("jitter_rms_deg"), .bound = kAsMuchJitter * jitter}};
  }
  const TuneBench bench(bound, TuneMetrics(bound), split, TunePart::kHeldOut, jobs);
  NearestFilter nearest{.forms = {}, .own = bench.Run({}, first)};
  if (!nearest.own.problem.empty()) throw RunError(plan.controller + ": " + nearest.own.problem);
  const auto begin = Clock::now();
  bench.Run({}, first);  // the first one also makes the signals, which the search keeps
  const std::chrono::duration<double> once = Clock::now() - begin;
  expect(once.count() * all * (plan.evaluations + 2.0));
  for (const FilterForm& form : forms) {
    const auto before = static_cast<double>(nearest.forms.size());
    nearest.forms.push_back(TuneForm(bound, split, form, jobs, [&](double done, double of) {
      return progress(before + done / of, all);
    }));
  }
  JudgeKinds(bound, nearest.forms);
  return nearest;
}

void TuneSomeKinds(const TunePlan& plan, const WorkRange& kinds) {
  const std::span<const controller::FilterKind> all = controller::FilterKinds();
  SearchKinds(plan,
              all.subspan(static_cast<std::size_t>(kinds.first),
                          static_cast<std::size_t>(kinds.end - kinds.first)),
              1, [](double, double) { return !StopAsked(); });
}

void AwaitKinds(const TunePlan& plan, Elsewhere& elsewhere,
                const std::function<bool(double done, double all)>& progress) {
  constexpr std::chrono::milliseconds kPatience{50};
  const auto count = std::ssize(controller::FilterKinds());
  const std::vector<WorkRange> parts = Divide({0, count}, elsewhere.most_parts());
  elsewhere.Begin(parts, {});
  double done = 0.0;
  for (std::size_t left = parts.size(); left > 0;) {
    ThrowIfStopped();
    const std::optional<Elsewhere::Part> part = elsewhere.Next(kPatience);
    if (!part) continue;
    --left;
    if (part->database.empty()) continue;
    plan.memo->Add(part->database);
    done += static_cast<double>(parts.at(part->number).end - parts.at(part->number).first);
    if (!progress(done, static_cast<double>(count))) throw Cancelled{};
  }
}

const TunedKind* NearestKind(const std::vector<TunedKind>& kinds) {
  const TunedKind* nearest = nullptr;
  const auto violation = [](const TunedKind& tuned) {
    return ViolationOf(tuned.plan, tuned.result, tuned.result.tried[*tuned.result.nearest]);
  };
  for (const TunedKind& tuned : kinds) {
    if (!tuned.result.nearest) continue;
    if (nearest == nullptr || violation(tuned) < violation(*nearest)) nearest = &tuned;
  }
  return nearest;
}

}  // namespace gauntlet::sim
