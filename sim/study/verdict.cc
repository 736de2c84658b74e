#include "sim/study/verdict.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <numeric>

#include "sim/results/table_text.h"
#include "sim/study/result_cells.h"
#include "sim/study/sweep_result.h"

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
    // Of those that follow as well as the best, the one that shakes least; one run has no such.
    const bool follows =
        summary.one_run ? controller.rank[tracking] == 1 : controller.as_good_as_best[tracking];
    if (follows && calmer(named.follower)) named.follower = &controller;
    if (calmer(named.calm)) named.calm = &controller;
  }
  return named;
}

/// What is asked of one run, without a word about chance.
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

/// What follows a controller's name in the verdict: whether it is known to be the best, only as
/// good as others, or the best of this sample alone.
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

/// Who follows best and who shakes least, of several runs.
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

void AddRemark(const char* key, std::string text, std::vector<VerdictRemark>& remarks) {
  if (!text.empty()) remarks.push_back({.key = key, .text = std::move(text)});
}

nlohmann::ordered_json JsonOfRemarks(const std::vector<VerdictRemark>& remarks) {
  auto json = nlohmann::ordered_json::array();
  for (const VerdictRemark& remark : remarks) {
    json.push_back({{"key", remark.key}, {"text", remark.text}});
  }
  return json;
}

/// What is not told apart from the best is no worse an answer: then nothing is recommended.
void AddUndecided(const std::vector<std::string>& undecided, Verdict& verdict) {
  if (undecided.empty()) return;
  AddRemark("undecided", fmt::format("It is undecided against {}.", fmt::join(undecided, "; ")),
            verdict.warnings);
  verdict.alternatives.insert(verdict.alternatives.begin(), verdict.recommended);
  verdict.alternatives.insert(verdict.alternatives.end(), undecided.begin(), undecided.end());
  verdict.recommended.clear();
}

constexpr const char* kWithoutHand = "Without a hand: confirm with physics before it counts.";

}  // namespace

std::string Verdict::Text() const {
  std::string text;
  for (const auto* remarks : {&reasons, &warnings}) {
    for (const VerdictRemark& remark : *remarks) text += (text.empty() ? "" : " ") + remark.text;
  }
  return text;
}

nlohmann::ordered_json JsonOf(const Verdict& verdict) {
  nlohmann::ordered_json json = {{"version", 1},
                                 {"recommended", nullptr},
                                 {"alternatives", verdict.alternatives},
                                 {"reasons", JsonOfRemarks(verdict.reasons)},
                                 {"warnings", JsonOfRemarks(verdict.warnings)}};
  if (!verdict.recommended.empty()) json["recommended"] = verdict.recommended;
  return json;
}

Verdict VerdictOf(const Summary& summary) {
  const std::size_t tracking = MetricIndex("tracking_rmse_deg");
  const std::size_t jitter = MetricIndex("jitter_rms_deg");
  const auto& all = summary.controllers;
  Verdict verdict;
  if (all.size() == 1) {
    if (all[0].rank[tracking] == 0 || all[0].rank[jitter] == 0) return verdict;
    AddRemark("scores",
              fmt::format("{} follows within {} deg RMS and shakes by {} deg RMS.", all[0].name,
                          Value(all[0], tracking), Value(all[0], jitter)),
              verdict.reasons);
    return verdict;
  }
  const Named named = WhomToName(summary);
  const auto& [follower, calm] = named;
  if (follower == nullptr || calm == nullptr) return verdict;
  if (summary.one_run) {
    AddRemark("tracking_and_jitter", VerdictOfOneRun(named, tracking, jitter), verdict.reasons);
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
  AddRemark("tracking_and_jitter", BestOf(summary, named, tracking, jitter), verdict.reasons);
  AddRemark("worse_than_baseline", Costs(summary, *follower), verdict.warnings);
  return verdict;
}

Verdict VerdictOf(const SweepPlan& plan, const SweepSummary& summary) {
  Verdict verdict;
  const std::string key(Metrics()[plan.best_by].key);
  if (summary.best.empty()) {
    AddRemark("constraints", "No cell keeps all constraints.", verdict.reasons);
  } else {
    const auto name_of = [](const CellResult& cell) {
      return fmt::format("cell {}, {}", cell.number, cell.controller);
    };
    const CellResult& best = summary.best.front();
    verdict.recommended = name_of(best);
    std::vector<std::string> undecided;
    for (const CellResult& cell : summary.best) {
      if (&cell == &best) continue;
      const CellComparison to_best = CompareCells(plan, cell, best, summary.results);
      if (to_best.judgement == Judgement::kEqual) verdict.alternatives.push_back(name_of(cell));
      if (to_best.judgement == Judgement::kUndecided) undecided.push_back(name_of(cell));
    }
    AddRemark("best_by", fmt::format("Best by {}: {}.", key, verdict.recommended), verdict.reasons);
    AddUndecided(undecided, verdict);
  }
  if (!plan.file.physics) AddRemark("without_hand", kWithoutHand, verdict.warnings);
  return verdict;
}

Verdict VerdictOf(const TunePlan& plan, const TuneResult& result) {
  if (!result.problem.empty()) return {.reasons = {{.key = "problem", .text = result.problem}}};
  Verdict verdict{.recommended = SettingsText(plan, result.tried[result.chosen].values)};
  const std::string_view judgement = JudgementText(result.gain.judgement);
  AddRemark("answer",
            fmt::format("{}: {}, against the setting before ({} {}).", verdict.recommended,
                        judgement.empty() ? "one seed decides nothing" : judgement,
                        IntervalText(result.gain.difference), Metrics()[plan.minimise].key),
            verdict.reasons);
  if (!plan.physics) AddRemark("without_hand", kWithoutHand, verdict.warnings);
  return verdict;
}

Verdict VerdictOf(const TunePlan& plan, const std::vector<TunedKind>& kinds) {
  Verdict verdict;
  if (!kinds.front().has_answer()) {
    AddRemark("constraints", "No kind of filter keeps the bounds.", verdict.reasons);
    return verdict;
  }
  verdict.recommended = kinds.front().kind;
  std::vector<std::string> undecided;
  for (const TunedKind& tuned : kinds) {
    if (!tuned.has_answer() || &tuned == &kinds.front()) continue;
    if (tuned.to_best.judgement == Judgement::kEqual) verdict.alternatives.push_back(tuned.kind);
    if (tuned.to_best.judgement == Judgement::kUndecided) undecided.push_back(tuned.kind);
  }
  const Metric& metric = Metrics()[plan.minimise];
  std::string text = fmt::format("{} has the {} {}", verdict.recommended,
                                 metric.lower_is_better ? "least" : "most", metric.key);
  if (!verdict.alternatives.empty()) {
    text +=
        fmt::format("; equal to it within what matters: {}", fmt::join(verdict.alternatives, ", "));
  }
  AddRemark("best_by", text + ".", verdict.reasons);
  AddUndecided(undecided, verdict);
  if (!plan.physics) AddRemark("without_hand", kWithoutHand, verdict.warnings);
  return verdict;
}

Verdict VerdictOf(const RobustPlan& plan, const RobustResult& result) {
  Verdict verdict;
  for (const RobustScore& score : result.scores) {
    const RobustController& best = score.controllers[score.two_best.front()];
    if (score.metric == plan.sweep.best_by) {
      verdict.recommended = best.name;
      std::vector<std::string> undecided;
      for (const ControllerSummary& controller : result.nominal.controllers) {
        if (controller.to_best[score.metric].judgement == Judgement::kUndecided) {
          undecided.push_back(controller.name);
        }
      }
      AddUndecided(undecided, verdict);
    }
    verdict.reasons.push_back(
        {.key = std::string(Metrics()[score.metric].key),
         .text = fmt::format("{}: {} is best on the scenario's own hand, and as good as the best "
                             "on {} of {} hands ({:.0f} to {:.0f} %).",
                             Metrics()[score.metric].key, best.name, best.near_best.hits,
                             best.near_best.count, std::floor(100.0 * best.near_best.low),
                             std::ceil(100.0 * best.near_best.high))});
  }
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
