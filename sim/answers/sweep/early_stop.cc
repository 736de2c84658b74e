#include "sim/answers/sweep/early_stop.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace gauntlet::sim {
namespace {

constexpr double kStopError = 0.05;

/// Does each score keep its bound, at the level of the test?
std::vector<Met> BoundsMet(const SweepPlan& plan, const CellResult& result, double level) {
  std::vector<Met> met;
  for (const Constraint& constraint : plan.constraints) {
    const auto& values = result.by_seed[PlaceOfMetric(plan, constraint.metric)];
    met.push_back(IsMet(constraint, EstimateMean(values, result.motions).IntervalAt(level)));
  }
  return met;
}

}  // namespace

std::vector<int> LooksOf(int seeds) {
  std::vector<int> looks;
  for (int first = 3; first < seeds; first = first == 3 ? 4 : 2 * first) {
    looks.push_back(first);
    if (first > 3 && 3 * first / 2 < seeds) looks.push_back(3 * first / 2);
  }
  return looks;
}

std::vector<bool> CannotWin(const SweepPlan& plan, std::span<const CellResult> alive,
                            std::size_t candidates, std::size_t looks) {
  // Two-sided intervals of this level have one side of half the rest.
  const double tests = static_cast<double>(looks) * (static_cast<double>(candidates) + 1.0) *
                       (static_cast<double>(plan.constraints.size()) + 1.0);
  const double level = 1.0 - 2.0 * kStopError / tests;
  const std::size_t score = PlaceOfMetric(plan, plan.best_by);
  const double sign = Metrics()[plan.best_by].lower_is_better ? 1.0 : -1.0;
  std::vector<bool> cannot(alive.size(), false);
  std::optional<std::size_t> leader;
  double least = 0.0;
  for (std::size_t i = 0; i < alive.size(); ++i) {
    if (!alive[i].problem.empty()) {
      cannot[i] = true;
      continue;
    }
    const std::vector<Met> met = BoundsMet(plan, alive[i], level);
    cannot[i] = std::ranges::any_of(met, [](Met m) { return m == Met::kNo; });
    const double mean = sign * EstimateMean(alive[i].by_seed[score], alive[i].motions).mean;
    const bool surely = std::ranges::all_of(met, [](Met m) { return m == Met::kYes; });
    if (!surely || std::isnan(mean) || (leader && mean >= least)) continue;
    leader = i;
    least = mean;
  }
  for (std::size_t i = 0; leader && i < alive.size(); ++i) {
    if (cannot[i] || i == *leader) continue;
    const MeanInterval behind =
        EstimateDifference(alive[i].by_seed[score], alive[*leader].by_seed[score], alive[i].motions)
            .IntervalAt(level);
    cannot[i] = sign > 0.0 ? behind.low > 0.0 : behind.high < 0.0;
  }
  return cannot;
}

}  // namespace gauntlet::sim
