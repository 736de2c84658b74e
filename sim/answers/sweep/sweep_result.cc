#include "sim/answers/sweep/sweep_result.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "sim/study/scenario/scenario_reader.h"

namespace gauntlet::sim {
namespace {

constexpr std::size_t kMostBest = 10;
constexpr std::size_t kMostNear = 3;

Met Worse(Met a, Met b) { return std::max(a, b); }

/// Score that decides, the lower the better, infinity if there is none.
double Rank(const SweepPlan& plan, const CellResult& result) {
  const double mean = result.scores[PlaceOfMetric(plan.metrics, plan.best_by)].mean;
  if (std::isnan(mean)) return std::numeric_limits<double>::infinity();
  return Metrics()[plan.best_by].lower_is_better ? mean : -mean;
}

/// Keeps the first few by rank; of equal ones the first cell.
void Offer(const SweepPlan& plan, const CellResult& result, std::size_t most,
           std::vector<CellResult>& kept) {
  const double rank = Rank(plan, result);
  const auto place =
      std::ranges::find_if(kept, [&](const CellResult& other) { return rank < Rank(plan, other); });
  if (place == kept.end() && kept.size() == most) return;
  kept.insert(place, result);
  if (kept.size() > most) kept.pop_back();
}

CellResult ResultOf(const SweepPlan& plan, SweepDatabase& database, int first_seed,
                    const SweepCellRecord& record) {
  CellResult result;
  result.number = record.number;
  result.controller = record.controller;
  result.values = plan.ValuesOf(record.number);
  result.problem = record.problem;
  result.scores.resize(plan.metrics.size());
  if (!record.problem.empty()) return result;
  result.by_seed.resize(plan.metrics.size());
  const int seeds = std::min<int>(plan.file.seeds, static_cast<int>(record.motions.size()));
  result.motions.assign(record.motions.begin(), record.motions.begin() + seeds);
  const auto outcomes =
      database.Read({record.study, record.controller, record.settings, first_seed}, seeds);
  for (int i = 0; i < seeds; ++i) {
    const std::optional<TrialOutcome>& outcome = outcomes[static_cast<std::size_t>(i)];
    const bool ok = outcome && outcome->health.ok;
    if (!ok && ++result.failed_trials == 1) {
      result.problem = outcome
                           ? fmt::format("{} (seed {})", outcome->health.problem, first_seed + i)
                           : fmt::format("seed {} is not there", first_seed + i);
    }
    for (std::size_t m = 0; m < plan.metrics.size(); ++m) {
      result.by_seed[m].push_back(ok ? outcome->scores.summary[plan.metrics[m]] : kNaN);
    }
  }
  for (std::size_t m = 0; m < plan.metrics.size(); ++m) {
    result.scores[m] = EstimateMean(result.by_seed[m], result.motions).IntervalAt();
  }
  for (const Constraint& constraint : plan.constraints) {
    result.met =
        Worse(result.met,
              IsMet(constraint, result.scores[PlaceOfMetric(plan.metrics, constraint.metric)]));
  }
  return result;
}

void Count(const SweepPlan& plan, const CellResult& result, SweepSummary& summary) {
  if (!result.problem.empty()) {
    (result.failed_trials > 0 ? summary.failed : summary.not_built) += 1;
    if (summary.first_problem.empty()) {
      summary.first_problem = fmt::format("setting {}: {}", result.number, result.problem);
    }
    return;
  }
  ++summary.results;
  if (result.CanBeBest()) {
    ++summary.meeting;
    Offer(plan, result, kMostBest, summary.best);
  } else {
    Offer(plan, result, kMostNear, summary.near);
  }
}

}  // namespace

std::size_t PlaceOfMetric(const std::vector<std::size_t>& metrics, std::size_t metric) {
  return static_cast<std::size_t>(std::ranges::find(metrics, metric) - metrics.begin());
}

std::string_view MetText(Met met) {
  static constexpr std::string_view kTexts[] = {"yes", "likely", "unlikely", "no", "no score"};
  return kTexts[static_cast<std::size_t>(met)];
}

Met IsMet(const Constraint& constraint, const MeanInterval& score) {
  if (std::isnan(score.mean)) return Met::kUnscored;
  const double sign = constraint.at_most ? 1.0 : -1.0;
  const double above = sign * (score.mean - constraint.bound);
  const double half_width = std::isnan(score.high) ? 0.0 : score.high - score.mean;
  if (above + half_width <= 0.0) return Met::kYes;
  if (above <= 0.0) return Met::kLikely;
  return above - half_width <= 0.0 ? Met::kUnlikely : Met::kNo;
}

void ForEachCell(const SweepPlan& plan, SweepDatabase& database, const CellRange& cells,
                 const std::function<void(const CellResult&)>& see) {
  const int first_seed = ParseScenario(plan.scenario).seed;
  database.ReadTogether([&] {
    for (std::int64_t number = cells.first; number < cells.end; ++number) {
      for (const SweepCellRecord& record : database.CellAt(number)) {
        see(ResultOf(plan, database, first_seed, record));
      }
    }
  });
}

SweepSummary SummariseSweep(const SweepPlan& plan, SweepDatabase& database, const CellRange& cells,
                            const std::function<void(const CellResult&)>& see) {
  SweepSummary summary;
  std::int64_t seen = 0;
  std::int64_t last = -1;
  ForEachCell(plan, database, cells, [&](const CellResult& result) {
    Count(plan, result, summary);
    if (see) see(result);
    if (result.number != last) ++seen;
    last = result.number;
  });
  summary.missing = cells.end - cells.first - seen;
  return summary;
}

Comparison ComparePaired(std::size_t metric, std::span<const double> first,
                         std::span<const double> second, std::span<const int> motions,
                         double pairs) {
  Comparison comparison;
  comparison.difference = EstimateDifference(first, second, motions)
                              .IntervalAt(1.0 - kFamilyError / std::max(1.0, pairs));
  comparison.relevant_difference = RelevantDifferenceBetween(
      Metrics()[metric], EstimateMean(first, motions).mean, EstimateMean(second, motions).mean);
  comparison.judgement = JudgeDifference(comparison.difference, comparison.relevant_difference,
                                         Metrics()[metric].lower_is_better);
  return comparison;
}

Comparison CompareCells(const SweepPlan& plan, const CellResult& first, const CellResult& second,
                        double pairs) {
  const std::size_t place = PlaceOfMetric(plan.metrics, plan.best_by);
  const std::size_t seeds = std::min(first.motions.size(), second.motions.size());
  return ComparePaired(plan.best_by, std::span(first.by_seed[place]).first(seeds),
                       std::span(second.by_seed[place]).first(seeds),
                       std::span(first.motions).first(seeds), pairs);
}

}  // namespace gauntlet::sim
