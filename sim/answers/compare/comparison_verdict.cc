#include "sim/answers/compare/comparison_verdict.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <numeric>
#include <optional>
#include <utility>

#include "sim/answers/compare/choice.h"
#include "sim/hand/hand_model.h"
#include "sim/results/table_text.h"
#include "sim/score/statistics/result_cells.h"

namespace gauntlet::sim {
namespace {

/// Share of the squared error from which on actuator saturation is worth a warning.
constexpr double kMuchSaturation = 0.1;

std::string Value(const Summary& summary, std::size_t controller, std::size_t metric) {
  return Short(summary.controllers[controller].summary[metric].mean);
}

std::string ValueWithUnit(const Summary& summary, std::size_t controller, std::size_t metric) {
  return ScoreValue(metric, summary.controllers[controller].summary[metric].mean);
}

std::string NamedValue(const Summary& summary, std::size_t controller, std::size_t metric) {
  return NamedScore(metric, summary.controllers[controller].summary[metric].mean);
}

/// "Use b: tracking error 4.45 deg RMS (raw 6.44), but delay 59 ms (raw 50); jitter equivalent."
std::string Recommendation(const Summary& summary, const Choice& choice, std::size_t recommended) {
  const std::string& name = summary.controllers[recommended].name;
  std::vector<std::string> better, worse, equal, undecided, plain;
  for (const std::size_t metric : choice.scores()) {
    const std::string value = NamedValue(summary, recommended, metric);
    plain.push_back(value);
    if (!summary.baseline || *summary.baseline == recommended) continue;
    const std::string against =
        fmt::format("{} ({} {})", value, summary.controllers[*summary.baseline].name,
                    Value(summary, *summary.baseline, metric));
    switch (choice.JudgementOf(metric, recommended, *summary.baseline)) {
      case Judgement::kBetter:
        better.push_back(against);
        break;
      case Judgement::kWorse:
        worse.push_back(against);
        break;
      case Judgement::kEqual:
        equal.emplace_back(Metrics()[metric].name);
        break;
      default:
        undecided.emplace_back(Metrics()[metric].name);
    }
  }
  if (!summary.baseline) return fmt::format("Use {}: {}.", name, Listed(plain));
  if (*summary.baseline == recommended) {
    return fmt::format("Use {}, the baseline: {}. No other controller is clearly better in {}.",
                       name, Listed(plain), Metrics()[summary.priority.metric].name);
  }
  std::string text = fmt::format("Use {}: {}", name, Listed(better));
  if (!worse.empty()) {
    text += fmt::format("{}{}", better.empty() ? "" : ", but ", Listed(worse));
  }
  const bool has_values = !better.empty() || !worse.empty();
  if (!equal.empty()) {
    text += fmt::format("{}{} equivalent", has_values ? "; " : "", Listed(equal));
  }
  if (!undecided.empty()) {
    text +=
        fmt::format("{}{} undecided", has_values || !equal.empty() ? "; " : "", Listed(undecided));
  }
  return text + ".";
}

std::string NamesOf(const Summary& summary, const Places& controllers) {
  std::vector<std::string> names;
  for (const std::size_t c : controllers) names.push_back(summary.controllers[c].name);
  return Listed(names);
}

/// "nearest (17.5) and noise_shaping (18.8)".
std::string ReversalsOf(const Summary& summary, const Places& controllers) {
  std::vector<std::string> values;
  for (const std::size_t c : controllers) {
    values.push_back(fmt::format("{} ({})", summary.controllers[c].name,
                                 Value(summary, c, MetricIndex("command_reversals_per_s"))));
  }
  return Listed(values);
}

/// "Equivalent: one_euro and mean_20." Without a baseline, where reversals decide: "Equivalent, but
/// with more command reversals per s than hysteresis (13.2): nearest (17.5) and noise_shaping
/// (18.8)."
std::string Ties(const Summary& summary, const Choice& choice, std::size_t recommended) {
  const Places ties = choice.equivalent();
  if (ties.empty()) return "";
  if (!choice.decides_by_reversals()) return fmt::format("Equivalent: {}.", NamesOf(summary, ties));
  return fmt::format("Equivalent, but with more command reversals per s than {}: {}.",
                     ReversalsOf(summary, {recommended}), ReversalsOf(summary, ties));
}

/// "Equivalent: any of a, b and c: tracking error 4.97 deg RMS, delay 119 ms and jitter 0.2 deg
/// RMS."
std::string AnyOf(const Summary& summary, const Choice& choice, Verdict& verdict) {
  const Places any = choice.any_of();
  for (const std::size_t c : any) verdict.alternatives.push_back(summary.controllers[c].name);
  std::vector<std::string> ranges;
  for (const std::size_t metric : choice.scores()) {
    const auto [least, most] = std::ranges::minmax(
        any, {}, [&](std::size_t c) { return summary.controllers[c].summary[metric].mean; });
    const std::string low = Value(summary, least, metric), high = Value(summary, most, metric);
    ranges.push_back(low == high ? NamedValue(summary, least, metric)
                                 : fmt::format("{} {} to {}", Metrics()[metric].name, low,
                                               ValueWithUnit(summary, most, metric)));
  }
  return fmt::format("Equivalent, use any: {} ({}).", Listed(verdict.alternatives), Listed(ranges));
}

/// "Use c if jitter matters more: 0.1 deg RMS instead of 0.2, but tracking error 6.8 deg RMS
/// instead of 4.5."
std::string Alternative(const Summary& summary, const Choice& choice, std::size_t metric,
                        std::size_t alternative, std::size_t recommended) {
  std::string text =
      fmt::format("Use {} if {} matters more: {} instead of {}",
                  summary.controllers[alternative].name, Metrics()[metric].name,
                  ValueWithUnit(summary, alternative, metric), Value(summary, recommended, metric));
  std::vector<std::string> price;
  for (const std::size_t other : choice.scores()) {
    if (choice.JudgementOf(other, alternative, recommended) != Judgement::kWorse) continue;
    price.push_back(fmt::format("{} instead of {}", NamedValue(summary, alternative, other),
                                Value(summary, recommended, other)));
  }
  return text + (price.empty() ? "" : ", but " + Listed(price)) + ".";
}

/// Reason why nothing is recommended after several runs.
std::string Undecided(const Summary& summary, const Choice& choice, Verdict& verdict) {
  const std::size_t metric = summary.priority.metric;
  if (std::ranges::count(choice.left_out(), metric) > 0) {
    return "No recommendation: the score of the priority has no value.";
  }
  const auto keeps = [&](std::size_t c) { return choice.KeepsBounds(c); };
  if (std::ranges::none_of(choice.all(), keeps)) {
    return fmt::format("No controller meets {}.", Listed(TextsOf(summary.priority.bounds)));
  }
  Places left = choice.not_beaten();
  if (left.empty()) {
    std::ranges::copy_if(choice.all(), std::back_inserter(left), [&](std::size_t c) {
      return keeps(c) && std::ranges::none_of(choice.all(), [&](std::size_t other) {
               return keeps(other) && choice.JudgementOf(metric, c, other) == Judgement::kWorse;
             });
    });
  }
  std::vector<std::string> values;
  for (const std::size_t c : left) {
    verdict.alternatives.push_back(summary.controllers[c].name);
    values.push_back(
        fmt::format("{} ({})", summary.controllers[c].name, ValueWithUnit(summary, c, metric)));
  }
  std::vector<std::string> undecided;
  for (const std::size_t score : choice.scores()) {
    const auto is_undecided = [&](std::size_t a, std::size_t b) {
      return choice.JudgementOf(score, a, b) == Judgement::kUndecided;
    };
    const bool is_open = std::ranges::any_of(left, [&](std::size_t a) {
      return std::ranges::any_of(left, [&](std::size_t b) { return is_undecided(a, b); });
    });
    if (is_open) undecided.emplace_back(Metrics()[score].name);
  }
  if (undecided.empty()) undecided.emplace_back(Metrics()[metric].name);
  return fmt::format("No recommendation: the {} of {} {} undecided. {} can decide it.",
                     Listed(undecided), Listed(values), undecided.size() == 1 ? "is" : "are",
                     summary.blocks.empty() ? "More seeds or recordings"
                                            : "A longer recording or more recordings");
}

/// "One run has no confidence interval, so nothing is recommended. Least tracking error: raw (4.5
/// deg RMS). .."
std::string OfOneRun(const Summary& summary, const Choice& choice) {
  std::string text = "One run has no confidence interval, so nothing is recommended.";
  for (const std::size_t metric : choice.scores()) {
    const auto best = std::ranges::min_element(choice.all(), {}, [&](std::size_t c) {
      return summary.controllers[c].summary[metric].mean;
    });
    text += fmt::format(" Least {}: {} ({}).", Metrics()[metric].name,
                        summary.controllers[*best].name, ValueWithUnit(summary, *best, metric));
  }
  return text;
}

/// Differences that are undecided, and small enough to count as equivalent.
std::string CountedAsEquivalent(const Summary& summary, const Choice& choice,
                                std::size_t recommended) {
  const std::size_t metric = summary.priority.metric;
  std::vector<std::string> others;
  for (const std::size_t other : choice.all()) {
    if (other == recommended || !choice.KeepsBounds(other)) continue;
    if (choice.JudgementOf(metric, recommended, other) != Judgement::kUndecided) continue;
    const double most = choice.MostWorse(metric, recommended, other);
    if (most <= summary.Of(metric, recommended, other).relevant_difference) continue;
    others.push_back(fmt::format("{} (at most {} {} worse)", summary.controllers[other].name,
                                 Short(most), Metrics()[metric].unit));
  }
  if (others.empty()) return "";
  return fmt::format("The {} of {} is undecided against {}, and counts as equivalent.",
                     Metrics()[metric].name, summary.controllers[recommended].name, Listed(others));
}

/// "Worse: command reversals 27.1 per s (raw 21.6)." The recommendation has the primary scores.
std::string Price(const Summary& summary, const Choice& choice, std::size_t recommended) {
  if (!summary.baseline || *summary.baseline == recommended) return "";
  std::vector<std::string> worse;
  bool is_worse = std::ranges::any_of(choice.scores(), [&](std::size_t metric) {
    return choice.JudgementOf(metric, recommended, *summary.baseline) == Judgement::kWorse;
  });
  for (const std::size_t metric : ShownMetrics(summary)) {
    if (summary.controllers[recommended].AgainstBaseline(metric) != Judgement::kWorse) continue;
    if (std::ranges::count(choice.scores(), metric) > 0) continue;
    is_worse = true;
    worse.push_back(fmt::format("{} ({} {})", NamedValue(summary, recommended, metric),
                                summary.controllers[*summary.baseline].name,
                                Value(summary, *summary.baseline, metric)));
  }
  if (!is_worse) return "No score is clearly worse.";
  return worse.empty() ? "" : fmt::format("Worse: {}.", Listed(worse));
}

std::string MayBreakBound(const Summary& summary, std::size_t recommended) {
  std::vector<std::string> open;
  for (const Constraint& bound : summary.priority.bounds) {
    const MeanInterval& score = summary.controllers[recommended].summary[bound.metric];
    if (bound.IsMetBy(bound.at_most ? score.high : score.low)) continue;
    open.push_back(
        fmt::format("{} (95 % CI {} to {})", bound.Text(), Short(score.low), Short(score.high)));
  }
  if (open.empty()) return "";
  return fmt::format("{} meets {} in the mean only.", summary.controllers[recommended].name,
                     Listed(open));
}

/// "Motors saturate: without their limits, the tracking error of raw is 4.10 deg in place of 6.97."
/// where the squared error would be a tenth less.
std::string Saturation(const Summary& summary, std::size_t controller) {
  const auto value = [&](std::size_t c, std::size_t metric) {
    return summary.controllers[c].summary[metric].mean;
  };
  const std::size_t without_limits = MetricIndex("error_without_saturation_deg");
  if (summary.baseline && !std::isfinite(value(controller, without_limits))) {
    controller = *summary.baseline;
  }
  const double without_deg = value(controller, without_limits);
  const double with_deg = value(controller, ErrorWithAll());
  if (!(without_deg * without_deg < (1.0 - kMuchSaturation) * with_deg * with_deg)) return "";
  const std::string part = PartOfCauses(summary);
  return fmt::format(
      "Motors saturate: without their limits, the tracking error of {} is {:.2f} deg in place of "
      "{:.2f}{}.",
      summary.controllers[controller].name, without_deg, with_deg,
      part.empty() ? "" : fmt::format(" ({})", part));
}

std::string Interpenetration(const Summary& summary) {
  const std::size_t metric = MetricIndex("digit_overlap_share");
  std::vector<double> shares;
  for (const ControllerSummary& controller : summary.controllers) {
    const double share = controller.summary[metric].mean;
    if (std::isfinite(share)) shares.push_back(100.0 * share);
  }
  if (shares.empty() || std::ranges::max(shares) < 0.5) return "";
  const std::string least = fmt::format("{:.0f}", std::ranges::min(shares));
  const std::string most = fmt::format("{:.0f}", std::ranges::max(shares));
  return fmt::format("Fingers interpenetrate for {} % of the time (hand.contact).",
                     least == most ? most : least + " to " + most);
}

/// "The arm makes 16 to 40 % of the finger jitter (first seed)." where it makes more than a tenth.
/// Jitter that is shown as 0.00 has no causes.
std::string JitterFromArm(const Summary& summary) {
  constexpr double kWorthSaying = 0.1;
  constexpr double kShownAs0_deg = 0.005;
  const std::size_t jitter = MetricIndex("finger_jitter_rms_deg");
  const std::size_t metric = MetricIndex("arm_share_of_finger_jitter");
  std::vector<double> shares;
  for (const ControllerSummary& controller : summary.controllers) {
    const double share = controller.summary[metric].mean;
    if (!std::isfinite(share) || !(controller.summary[jitter].mean >= kShownAs0_deg)) continue;
    shares.push_back(share);
  }
  if (shares.empty() || std::ranges::max(shares) <= kWorthSaying) return "";
  const auto [least, most] = std::ranges::minmax(shares);
  const std::string part = PartOfCauses(summary);
  return fmt::format("The arm makes {:.0f}{} % of the finger jitter{}.",
                     100.0 * std::max(0.0, least),
                     shares.size() == 1 ? "" : fmt::format(" to {:.0f}", 100.0 * most),
                     part.empty() ? "" : fmt::format(" ({})", part));
}

/// "The object falls with raw in 100 % of trials and with mean_20 in 25 %."
std::string Dropped(const Summary& summary) {
  const std::size_t metric = MetricIndex("object_dropped_share");
  std::vector<std::string> dropped;
  for (const ControllerSummary& controller : summary.controllers) {
    const double share = controller.summary[metric].mean;
    if (!(share > 0.0) || controller.failed_trials > 0) continue;
    dropped.push_back(fmt::format("with {} in {:.0f} %{}", controller.name, 100.0 * share,
                                  dropped.empty() ? " of trials" : ""));
  }
  return dropped.empty() ? "" : fmt::format("The object falls {}.", Listed(dropped));
}

void AddWarnings(const Summary& summary, const Choice& choice,
                 std::optional<std::size_t> recommended, Verdict& verdict) {
  for (const std::size_t metric : choice.left_out()) {
    if (choice.all().empty()) break;
    const std::string why = metric < summary.no_value.size() ? summary.no_value[metric] : "";
    verdict.AddWarning(
        "no_value", fmt::format("The {} has no value for some controllers, so it is not judged{}.",
                                Metrics()[metric].name, why.empty() ? "" : ": " + why));
  }
  if (recommended) {
    verdict.AddWarning("undecided", CountedAsEquivalent(summary, choice, *recommended));
    verdict.AddWarning("bounds", MayBreakBound(summary, *recommended));
  }
  if (!summary.blocks.empty()) {
    verdict.AddWarning("one_recording",
                       fmt::format("The confidence intervals are from {} of this recording: one "
                                   "session of one person. They are too narrow if it has few fast "
                                   "movements.",
                                   summary.blocks.Text()));
  } else if (!summary.one_run && summary.motions == 1) {
    verdict.AddWarning("one_motion", "One motion: the confidence intervals cover noise only.");
  }
  if (!choice.all().empty()) {
    verdict.AddWarning("saturation",
                       Saturation(summary, recommended.value_or(choice.all().front())));
  }
  verdict.AddWarning("interpenetration", Interpenetration(summary));
  verdict.AddWarning("arm_jitter", JitterFromArm(summary));
  verdict.AddWarning("dropped", Dropped(summary));
}

Verdict VerdictOf(const Summary& summary, const Choice& choice) {
  Verdict verdict;
  verdict.AddWarning("engine", HandModel::EngineNote());
  for (const std::string& assumed : summary.assumed) verdict.AddWarning("assumed", assumed);
  const std::optional<std::size_t> recommended = choice.recommended();
  if (choice.all().empty()) {
    verdict.AddReason("none", "No controller has a score, so nothing is recommended.");
  } else if (summary.controllers.size() == 1) {
    std::vector<std::string> values;
    for (const std::size_t metric : choice.scores())
      values.push_back(NamedValue(summary, 0, metric));
    verdict.AddReason("scores",
                      fmt::format("{}: {}.", summary.controllers[0].name, Listed(values)));
  } else if (summary.one_run) {
    verdict.AddReason("one_run", OfOneRun(summary, choice));
  } else if (!recommended) {
    if (choice.any_of().empty()) {
      verdict.AddReason("undecided", Undecided(summary, choice, verdict));
    } else {
      verdict.AddReason("equivalent", AnyOf(summary, choice, verdict));
    }
  } else {
    verdict.recommended = summary.controllers[*recommended].name;
    verdict.AddReason("recommended", Recommendation(summary, choice, *recommended));
    verdict.AddReason("price", Price(summary, choice, *recommended));
    verdict.AddReason("equivalent", Ties(summary, choice, *recommended));
    for (const auto& [metric, c] : choice.alternatives()) {
      verdict.alternatives.push_back(summary.controllers[c].name);
      verdict.AddReason("alternative", Alternative(summary, choice, metric, c, *recommended));
    }
  }
  const bool chooses = summary.controllers.size() > 1 && recommended;
  AddWarnings(summary, choice, chooses ? recommended : std::nullopt, verdict);
  return verdict;
}

/// Recommended, alternatives, the others by tracking error.
Places OrderOf(const Summary& summary, const Choice& choice) {
  Places first;
  if (const auto recommended = choice.recommended()) first.push_back(*recommended);
  for (const auto& [metric, c] : choice.alternatives()) first.push_back(c);
  const std::size_t tracking = MetricIndex("tracking_rmse_deg");
  Places order(summary.controllers.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, {}, [&](std::size_t c) {
    const double mean = summary.controllers[c].summary[tracking].mean;
    return std::pair(std::ranges::find(first, c) - first.begin(),
                     std::isfinite(mean) ? mean : std::numeric_limits<double>::infinity());
  });
  return order;
}

Places ShownOf(const Summary& summary, const Choice& choice, const Places& order) {
  constexpr std::size_t kMost = 3;
  Places shown;
  const auto add = [&shown](std::size_t c) {
    if (shown.size() < kMost && std::ranges::count(shown, c) == 0) shown.push_back(c);
  };
  if (summary.baseline) add(*summary.baseline);
  if (const auto recommended = choice.recommended()) {
    add(*recommended);
    for (const auto& [metric, c] : choice.alternatives()) add(c);
  }
  if (shown.size() < 2 || !choice.recommended()) {
    for (const std::size_t c : order) add(c);
  }
  return shown;
}

std::vector<std::string> RolesOf(const Summary& summary, const Choice& choice) {
  std::vector<std::string> roles(summary.controllers.size());
  const auto add = [&roles](std::size_t c, const std::string& role) {
    roles[c] += (roles[c].empty() ? "" : ", ") + role;
  };
  if (summary.controllers.size() == 1) return roles;
  if (const auto recommended = choice.recommended()) {
    add(*recommended, "recommended");
    for (const std::size_t c : choice.equivalent()) add(c, "equivalent");
  }
  for (const std::size_t c : choice.any_of()) add(c, "equivalent");
  for (const auto& [metric, c] : choice.alternatives()) {
    add(c, fmt::format("less {}", Metrics()[metric].name));
  }
  for (std::size_t c = 0; c < roles.size(); ++c) {
    if (summary.controllers[c].failed_trials > 0) add(c, "failed");
  }
  if (summary.baseline) add(*summary.baseline, "baseline");
  return roles;
}

}  // namespace

ComparisonAnswer AnswerOf(const Summary& summary) {
  const Choice choice(summary);
  ComparisonAnswer answer{.verdict = VerdictOf(summary, choice),
                          .order = OrderOf(summary, choice),
                          .shown = {},
                          .roles = RolesOf(summary, choice)};
  answer.shown = ShownOf(summary, choice, answer.order);
  return answer;
}

std::vector<std::size_t> ShownMetrics(const Summary& summary) {
  std::vector<std::size_t> shown = DetailedMetrics(summary);
  std::erase_if(shown, [](std::size_t metric) { return !Metrics()[metric].main; });
  return shown;
}

std::vector<std::size_t> DetailedMetrics(const Summary& summary) {
  std::vector<std::size_t> shown;
  for (std::size_t m = 0; m < Metrics().size(); ++m) {
    const auto has_value = [m](const ControllerSummary& controller) {
      return std::isfinite(controller.summary[m].mean);
    };
    const bool is_wanted = Metrics()[m].main || Metrics()[m].detailed;
    if (is_wanted && std::ranges::any_of(summary.controllers, has_value)) shown.push_back(m);
  }
  return shown;
}

}  // namespace gauntlet::sim
