#include "sim/comparison/comparison_verdict.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "sim/results/table_text.h"

namespace gauntlet::sim {
namespace {

std::string Value(const ControllerSummary& controller, std::size_t metric) {
  return Short(controller.summary[metric].mean);
}

/// Whom the verdict names: who follows best, and who shakes least. None where nobody has a score.
struct Named {
  const ControllerSummary* follower = nullptr;
  const ControllerSummary* calm = nullptr;
};

Named WhomToName(const Summary& summary) {
  const std::size_t tracking = MetricIndex("tracking_rmse_deg");
  const std::size_t jitter = MetricIndex("jitter_rms_deg");
  Named named;
  for (const ControllerSummary& controller : summary.controllers) {
    if (controller.rank[jitter] == 0) continue;
    const auto calmer = [&](const ControllerSummary* than) {
      return than == nullptr || controller.summary[jitter].mean < than->summary[jitter].mean;
    };
    // The one with the least jitter among those that track as well as the best. One run has no
    // such.
    const bool follows =
        summary.one_run ? controller.rank[tracking] == 1 : controller.as_good_as_best[tracking];
    if (follows && calmer(named.follower)) named.follower = &controller;
    if (calmer(named.calm)) named.calm = &controller;
  }
  return named;
}

/// The sentence about a single run, which says nothing about chance.
std::string VerdictOfOneRun(const Named& named, std::size_t tracking, std::size_t jitter) {
  const auto& [follower, calm] = named;
  if (follower == calm) {
    return fmt::format(
        "In this one run {} follows nearest ({} deg RMS) and shakes least ({} deg RMS).",
        follower->name, Value(*follower, tracking), Value(*follower, jitter));
  }
  return fmt::format(
      "In this one run {} follows nearest ({} deg RMS, jitter {}); {} shakes least ({} deg RMS, "
      "tracking {}).",
      follower->name, Value(*follower, tracking), Value(*follower, jitter), calm->name,
      Value(*calm, jitter), Value(*calm, tracking));
}

/// The words that follow the name of a controller in the verdict: it is the best, as good as
/// others, or the best of this sample alone.
std::string Superlative(const Summary& summary, std::size_t metric, const char* best,
                        const char* as_good_as_any, const char* not_decided) {
  int stars = 0;
  bool undecided = false;
  for (const ControllerSummary& controller : summary.controllers) {
    stars += controller.as_good_as_best[metric] ? 1 : 0;
    undecided |= controller.to_best[metric].judgement == Judgement::kUndecided;
  }
  return stars > 1 ? as_good_as_any : undecided ? not_decided : best;
}

/// "mean_20 is worse than raw in delay_ms."; empty if it is so in no main metric.
std::string Costs(const Summary& summary, const ControllerSummary& controller) {
  std::string worse;
  for (const std::size_t metric : ShownMetrics(summary)) {
    if (!controller.IsWorseThanBaseline(metric)) continue;
    if (!worse.empty()) worse += ", ";
    worse += Metrics()[metric].key;
  }
  if (worse.empty()) return "";
  return fmt::format("{} is worse than {} in {}.", controller.name,
                     summary.controllers[*summary.baseline].name, worse);
}

/// The sentence about tracking and jitter of several runs.
std::string BestOf(const Summary& summary, const Named& named, std::size_t tracking,
                   std::size_t jitter) {
  const auto& [follower, calm] = named;
  const std::string follows =
      Superlative(summary, tracking, "follows best", "follows as well as any", "may follow best");
  const std::string shakes =
      Superlative(summary, jitter, "shakes least", "shakes as little as any", "may shake least");
  std::string text;
  if (follower->as_good_as_best[jitter]) {
    text = fmt::format("{} {} ({} deg RMS) and {} ({} deg RMS)", follower->name, follows,
                       Value(*follower, tracking), shakes, Value(*follower, jitter));
  } else {
    text =
        fmt::format("{} {} ({} deg RMS, jitter {}); {} {} ({} deg RMS, tracking {})",
                    follower->name, follows, Value(*follower, tracking), Value(*follower, jitter),
                    calm->name, shakes, Value(*calm, jitter), Value(*calm, tracking));
  }
  if (summary.baseline && follower != &summary.controllers[*summary.baseline]) {
    const ControllerSummary& baseline = summary.controllers[*summary.baseline];
    text += fmt::format("; {}: {} and {}", baseline.name, Value(baseline, tracking),
                        Value(baseline, jitter));
  }
  return text + ".";
}

}  // namespace

Verdict VerdictOf(const Summary& summary) {
  const std::size_t tracking = MetricIndex("tracking_rmse_deg");
  const std::size_t jitter = MetricIndex("jitter_rms_deg");
  const auto& all = summary.controllers;
  Verdict verdict;
  if (all.size() == 1) {
    if (all[0].rank[tracking] == 0 || all[0].rank[jitter] == 0) return verdict;
    verdict.AddReason(
        "scores", fmt::format("{} follows within {} deg RMS and shakes by {} deg RMS.", all[0].name,
                              Value(all[0], tracking), Value(all[0], jitter)));
    return verdict;
  }
  const Named named = WhomToName(summary);
  const auto& [follower, calm] = named;
  if (follower == nullptr || calm == nullptr) return verdict;
  if (summary.one_run) {
    verdict.AddReason("tracking_and_jitter", VerdictOfOneRun(named, tracking, jitter));
    return verdict;
  }
  const auto may_follow_best = [&](const ControllerSummary& controller) {
    return controller.as_good_as_best[tracking] ||
           controller.to_best[tracking].judgement == Judgement::kUndecided;
  };
  const bool is_decided = std::ranges::none_of(all, [&](const ControllerSummary& controller) {
    return controller.to_best[tracking].judgement == Judgement::kUndecided;
  });
  if (is_decided) verdict.recommended = follower->name;
  for (const ControllerSummary& controller : all) {
    const bool is_other = !is_decided || &controller != follower;
    if (is_other && (&controller == calm || may_follow_best(controller))) {
      verdict.alternatives.push_back(controller.name);
    }
  }
  verdict.AddReason("tracking_and_jitter", BestOf(summary, named, tracking, jitter));
  verdict.AddWarning("worse_than_baseline", Costs(summary, *follower));
  return verdict;
}

std::vector<std::size_t> OrderOfVerdict(const Summary& summary) {
  const std::size_t tracking = MetricIndex("tracking_rmse_deg");
  const Named named = WhomToName(summary);
  // Those whom it names, then as they follow; who has no score comes last.
  const auto key = [&](std::size_t index) {
    const ControllerSummary& controller = summary.controllers[index];
    const double mean = controller.summary[tracking].mean;
    const int place = &controller == named.follower ? 0 : &controller == named.calm ? 1 : 2;
    return std::pair(place, std::isfinite(mean) ? mean : std::numeric_limits<double>::infinity());
  };
  std::vector<std::size_t> order(summary.controllers.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, {}, key);
  return order;
}

std::vector<std::size_t> ShownMetrics(const Summary& summary) {
  std::vector<std::size_t> shown;
  for (std::size_t m = 0; m < Metrics().size(); ++m) {
    const auto has_value = [m](const ControllerSummary& controller) {
      return std::isfinite(controller.summary[m].mean);
    };
    if (Metrics()[m].main && std::ranges::any_of(summary.controllers, has_value)) {
      shown.push_back(m);
    }
  }
  return shown;
}

}  // namespace gauntlet::sim
