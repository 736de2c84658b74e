#include "sim/study/summary.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <variant>

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

/// A controller that does nothing against noise: what every filter has to beat.
bool IsRaw(const controller::ControllerConfig& config) {
  return std::all_of(config.filters.begin(), config.filters.end(),
                     [](const controller::FilterConfig& filter) {
                       return std::holds_alternative<controller::NoFilterConfig>(filter.settings);
                     });
}

int FindRaw(const Scenario& scenario) {
  const auto found = std::find_if(scenario.controllers.begin(), scenario.controllers.end(),
                                  [](const NamedController& named) { return IsRaw(named.config); });
  return found == scenario.controllers.end()
             ? -1
             : static_cast<int>(found - scenario.controllers.begin());
}

std::vector<std::vector<double>> ChannelMeans(const StudyResult& result, std::size_t controller) {
  std::vector<std::vector<double>> means;
  for (std::size_t c = 0; c < result.channel_names.size(); ++c) {
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

/// Whether the whole interval of a difference lies on the wrong side. A study of one seed has no
/// interval: there the plain difference decides. Where several seeds leave one pair, nothing does.
bool IsWorse(const MeanInterval& difference, const Metric& metric, bool one_seed) {
  const double low = one_seed ? difference.mean : difference.ci95_low;
  const double high = one_seed ? difference.mean : difference.ci95_high;
  return metric.lower_is_better ? low > 0.0 : high < 0.0;
}

void CompareWithRaw(const std::vector<double>& values, const std::vector<double>& raw,
                    const Metric& metric, std::uint64_t seed, ControllerSummary& summary) {
  const MeanInterval difference = PairedDifference(values, raw, seed);
  summary.difference_to_raw.push_back(difference);
  summary.effect_size.push_back(PairedEffectSize(values, raw));
  summary.worse_than_raw.push_back(IsWorse(difference, metric, values.size() == 1));
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
      controller.as_good_as_best.push_back(
          controller.rank[m] == 1 ||
          (controller.rank[m] > 1 &&
           !IsWorse(
               PairedDifference(SeedValues(result, c, m), SeedValues(result, best_index, m), seed),
               Metrics()[m], result.seeds.size() == 1)));
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
  summary.raw = FindRaw(study.scenario);
  for (std::size_t c = 0; c < result.controller_names.size(); ++c) {
    ControllerSummary& controller = summary.controllers.emplace_back();
    controller.name = result.controller_names[c];
    controller.problem = FirstProblem(result, c);
    controller.channels = ChannelMeans(result, c);
    const bool is_raw = summary.raw == static_cast<int>(c);
    for (std::size_t m = 0; m < Metrics().size(); ++m) {
      const std::vector<double> values = SeedValues(result, c, m);
      controller.summary.push_back(BootstrapMean(values, seed));
      if (summary.raw < 0 || is_raw) continue;
      CompareWithRaw(values, SeedValues(result, static_cast<std::size_t>(summary.raw), m),
                     Metrics()[m], seed, controller);
    }
  }
  RankControllers(summary);
  FindAsGoodAsBest(result, seed, summary);
  summary.dominated = DominatedControllers(summary);
  return summary;
}

}  // namespace gauntlet::sim
