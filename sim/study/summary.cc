#include "sim/study/summary.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace gauntlet::sim {
namespace {

/// Values of one metric and controller, one per seed.
std::vector<double> SeedValues(const StudyResult& result, std::size_t controller,
                               std::size_t metric) {
  std::vector<double> values;
  for (const SeedOutcome& seed : result.seeds) {
    values.push_back(seed.controllers[controller].scores.summary[metric]);
  }
  return values;
}

std::vector<std::vector<double>> RowMeans(const StudyResult& result, std::size_t controller) {
  std::vector<std::vector<double>> means;
  for (std::size_t c = 0; c < result.row_names.size(); ++c) {
    std::vector<double>& row = means.emplace_back();
    for (std::size_t m = 0; m < Metrics().size(); ++m) {
      double sum = 0.0;
      int count = 0;
      for (const SeedOutcome& seed : result.seeds) {
        const double value = seed.controllers[controller].scores.channels[c][m];
        if (!std::isfinite(value)) continue;
        sum += value;
        ++count;
      }
      row.push_back(count > 0 ? sum / count : std::numeric_limits<double>::quiet_NaN());
    }
  }
  return means;
}

/// Whether the whole interval of a difference lies on the wrong side.
bool IsWorse(const MeanInterval& difference, const Metric& metric) {
  return metric.lower_is_better ? difference.ci95_low > 0.0 : difference.ci95_high < 0.0;
}

void CompareWithBaseline(const std::vector<double>& values, const std::vector<double>& baseline,
                         const Metric& metric, std::uint64_t seed, ControllerSummary& summary) {
  const MeanInterval difference = PairedDifference(values, baseline, seed);
  summary.difference_to_baseline.push_back(difference);
  summary.effect_size.push_back(PairedEffectSize(values, baseline));
  summary.worse_than_baseline.push_back(IsWorse(difference, metric));
}

std::string FirstProblem(const StudyResult& result, std::size_t controller) {
  for (const SeedOutcome& seed : result.seeds) {
    const HandHealth& health = seed.controllers[controller].health;
    if (!health.ok) return health.problem + " (seed " + std::to_string(seed.seed) + ")";
  }
  return "";
}

void FindAsGoodAsBest(const StudyResult& result, std::uint64_t seed, Summary& summary) {
  for (std::size_t m = 0; m < Metrics().size(); ++m) {
    const auto best = std::find_if(summary.controllers.begin(), summary.controllers.end(),
                                   [&](const auto& c) { return c.rank[m] == 1; });
    const auto best_index = static_cast<std::size_t>(best - summary.controllers.begin());
    for (std::size_t c = 0; c < summary.controllers.size(); ++c) {
      ControllerSummary& controller = summary.controllers[c];
      const auto worse = [&] {
        return IsWorse(
            PairedDifference(SeedValues(result, c, m), SeedValues(result, best_index, m), seed),
            Metrics()[m]);
      };
      controller.as_good_as_best.push_back(
          !summary.one_run && (controller.rank[m] == 1 || (controller.rank[m] > 1 && !worse())));
    }
  }
}

void RankControllers(Summary& summary) {
  for (std::size_t m = 0; m < Metrics().size(); ++m) {
    std::vector<double> means;
    for (const ControllerSummary& c : summary.controllers) means.push_back(c.summary[m].mean);
    const std::vector<int> ranks = Ranking(means, Metrics()[m].lower_is_better);
    for (std::size_t c = 0; c < ranks.size(); ++c) summary.controllers[c].rank.push_back(ranks[c]);
  }
}

std::vector<bool> DominatedControllers(const Summary& summary) {
  std::vector<double> jitter;
  std::vector<double> delay;
  for (const ControllerSummary& controller : summary.controllers) {
    jitter.push_back(controller.summary[MetricIndex("jitter_rms_deg")].mean);
    delay.push_back(controller.summary[MetricIndex("delay_ms")].mean);
  }
  return DominatedPoints(jitter, delay);
}

}  // namespace

Summary Summarise(const Study& study, const StudyResult& result) {
  const auto seed = static_cast<std::uint64_t>(study.scenario.seed);
  Summary summary;
  summary.baseline = BaselineOf(study.scenario);
  summary.one_run = result.seeds.size() < 2;
  for (std::size_t c = 0; c < result.controller_names.size(); ++c) {
    ControllerSummary& controller = summary.controllers.emplace_back();
    controller.name = result.controller_names[c];
    controller.problem = FirstProblem(result, c);
    controller.rows = RowMeans(result, c);
    for (std::size_t m = 0; m < Metrics().size(); ++m) {
      const std::vector<double> values = SeedValues(result, c, m);
      controller.summary.push_back(BootstrapMean(values, seed));
      if (!summary.baseline || *summary.baseline == c) continue;
      CompareWithBaseline(values, SeedValues(result, *summary.baseline, m), Metrics()[m], seed,
                          controller);
    }
  }
  RankControllers(summary);
  FindAsGoodAsBest(result, seed, summary);
  summary.dominated = DominatedControllers(summary);
  return summary;
}

}  // namespace gauntlet::sim
