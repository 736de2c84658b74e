#include "sim/report/score_table.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>
#include <numeric>
#include <utility>
#include <vector>

#include "sim/report/error_split_table.h"
#include "sim/report/prediction_text.h"

namespace gauntlet::sim {
namespace {

constexpr int kHeadLines = 4;

/// The main metrics that some controller has a value of.
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

/// What stands above a column, from the top: the words of the metric's key. Below each other they
/// take less room, and read downwards they are the key.
std::string HeadOf(std::string_view key) {
  std::string head(key);
  const bool is_rate = key.ends_with("_per_s") || key.ends_with("_deg_s");  // which stays together
  std::size_t place = is_rate ? head.rfind('_') : head.size();
  for (int lines = 1; lines < kHeadLines; ++lines) {
    place = head.rfind('_', place - 1);
    if (place == std::string::npos) break;
    head[place] = kBreak;
  }
  return head;
}

/// "+0.41" and "±0.05", with as many digits as the interval allows; one alone where nothing else is
/// known.
std::string DifferenceText(const MeanInterval& difference) {
  const double half_width = difference.high - difference.mean;
  if (std::isnan(difference.mean)) return "";
  if (!(half_width > 0.0)) {
    return fmt::format("{}{}", difference.mean >= 0.0 ? "+" : "", Short(difference.mean));
  }
  const int decimals = std::clamp(1 - static_cast<int>(std::floor(std::log10(half_width))), 0, 3);
  return fmt::format("{:+.{}f}{}±{:.{}f}", difference.mean, decimals, kSoftBreak, half_width,
                     decimals);
}

/// What the table says of a controller's metric: its value, below it the difference to the best.
ResultCell CellOf(const Summary& summary, const ControllerSummary& controller, std::size_t metric) {
  const MeanInterval& own = controller.summary[metric];
  ResultCell cell(own.mean);
  const auto add_line = [&cell](const std::string& text) {
    if (!text.empty()) cell.text += kBreak + text;
  };
  if (summary.one_run) return cell;
  if (summary.controllers.size() == 1) {  // has nobody to differ from
    if (std::isfinite(own.low)) add_line(fmt::format("±{}", Short(own.high - own.mean)));
    return cell;
  }
  const Comparison& to_best = controller.to_best[metric];
  if (controller.as_good_as_best[metric]) {
    cell.mark = '*';
  } else if (to_best.judgement == Judgement::kUndecided) {
    cell.mark = '~';
  }
  if (controller.IsWorseThanBaseline(metric)) cell.mark = '!';
  const bool is_best = controller.as_good_as_best[metric] && to_best.judgement == Judgement::kNone;
  add_line(is_best ? "best" : DifferenceText(to_best.difference));
  return cell;
}

ResultTable MeansTable(const Summary& summary) {
  ResultTable table{.columns = {{"name", "controller"}}};
  const std::vector<std::size_t> shown = ShownMetrics(summary);
  for (const std::size_t metric : shown) {
    const std::string_view key = Metrics()[metric].key;
    table.columns.push_back({std::string(key), HeadOf(key)});
  }
  for (const ControllerSummary& controller : summary.controllers) {
    ResultRow& row = table.rows.emplace_back(ResultRow{ResultCell(controller.name)});
    for (const std::size_t metric : shown) row.push_back(CellOf(summary, controller, metric));
  }
  return table;
}

/// Where a score of the table is a mean over some of the seeds, as the others have none.
std::vector<std::string> MissingSeeds(const StudyResult& result, const Summary& summary) {
  std::vector<std::string> missing;
  const int seeds = result.seeds.size();
  for (const ControllerSummary& controller : summary.controllers) {
    for (const std::size_t metric : ShownMetrics(summary)) {
      const int count = controller.summary[metric].count;
      if (count == 0 || count == seeds || controller.failed_trials > 0) continue;
      missing.push_back(fmt::format("{}: {} from {} of {} seeds; the others have none",
                                    controller.name, Metrics()[metric].key, count, seeds));
    }
  }
  return missing;
}

}  // namespace

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

/// Why there is no interval, star or flag.
std::string ReasonForNoChance(const StudyResult& result) {
  if (result.seeds_alike) {
    return "Every seed gives the same run, as nothing in it is drawn at random: one was run, and "
           "there is no interval, no star and no flag.";
  }
  return "One seed tells nothing about chance: no interval, no star, no flag (gauntlet compare "
         "runs several).";
}

std::string Legend(const Summary& summary) {
  std::string legend = "* best, or equal within what matters   ~ undecided";
  if (summary.baseline) {
    legend += "   ! worse than " + summary.controllers[*summary.baseline].name;
  }
  return legend;
}

/// "97 % the motions' and 3 % the noise's", a mean over controllers; empty where it is not known.
std::string SharesText(const Summary& summary, const auto& interval_of) {
  double sum = 0.0;
  int count = 0;
  for (const ControllerSummary& controller : summary.controllers) {
    const double share = interval_of(controller).motion_share;
    if (controller.failed_trials > 0 || std::isnan(share)) continue;
    sum += share;
    ++count;
  }
  if (count == 0) return "";
  const double percent = std::round(100.0 * sum / count);
  return fmt::format("{:.0f} % the motions' and {:.0f} % the noise's", percent, 100.0 - percent);
}

/// Whose the scatter of tracking is, and that of its differences; empty where it is not known.
std::string WhoseScatter(const Summary& summary) {
  const std::size_t tracking = MetricIndex("tracking_rmse_deg");
  const std::string of_values =
      SharesText(summary, [&](const auto& c) { return c.summary[tracking]; });
  const std::string of_differences =
      SharesText(summary, [&](const auto& c) { return c.to_best[tracking].difference; });
  if (of_values.empty()) return "";
  std::string text = fmt::format("The variance of {} is {}", Metrics()[tracking].key, of_values);
  if (!of_differences.empty()) text += fmt::format("; that of its differences {}", of_differences);
  return text + ".";
}

std::string WhatMatters(const Summary& summary) {
  std::string text;
  for (const std::size_t metric : ShownMetrics(summary)) {
    const RelevantDifference& least = Metrics()[metric].relevant_difference;
    if (!text.empty()) text += ", ";
    text += std::string(Metrics()[metric].key);
    if (least.absolute > 0.0) text += fmt::format(" {:g}", least.absolute);
    if (least.absolute > 0.0 && least.relative > 0.0) text += " or";
    if (least.relative > 0.0) text += fmt::format(" {:g} %", 100.0 * least.relative);
  }
  return fmt::format("Differences matter from here on: {} (gauntlet list metrics says why).", text);
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

/// " mean_20 is worse than raw in delay_ms."; empty if it is so in no main metric.
std::string Costs(const Summary& summary, const ControllerSummary& controller) {
  std::string worse;
  for (const std::size_t metric : ShownMetrics(summary)) {
    if (!controller.IsWorseThanBaseline(metric)) continue;
    if (!worse.empty()) worse += ", ";
    worse += Metrics()[metric].key;
  }
  if (worse.empty()) return "";
  return fmt::format(" {} is worse than {} in {}.", controller.name,
                     summary.controllers[*summary.baseline].name, worse);
}

/// Of all controllers' hands; empty where digits stayed apart.
std::string DigitsInEachOther(const Summary& summary) {
  const std::size_t metric = MetricIndex("digit_overlap_share");
  double least = 1.0;
  double most = 0.0;
  for (const ControllerSummary& controller : summary.controllers) {
    const double share = controller.summary[metric].mean;
    if (std::isnan(share)) continue;
    least = std::min(least, share);
    most = std::max(most, share);
  }
  if (most == 0.0) return "";
  const std::string shortest = fmt::format("{:.1f}", 100.0 * least);
  const std::string longest = fmt::format("{:.1f}", 100.0 * most);
  return fmt::format(
      "Digits of the hand were in each other for {} % of the time "
      "(digit_overlap_share).",
      shortest == longest ? longest : fmt::format("{} to {}", shortest, longest));
}

/// What a table of several seeds says of chance.
std::vector<std::string> NotesOnChance(const Summary& summary) {
  std::vector<std::string> notes;
  if (summary.controllers.size() == 1) {
    notes.emplace_back("± half of the 95 % interval of the mean.");
  }
  if (summary.pairs > 0) {
    notes.push_back(fmt::format(
        "Differences are to the best of the column, paired by seed, ± half of the interval that "
        "decides: those of all {} pairs hold together with 95 % (Bonferroni).",
        summary.pairs));
    notes.push_back(WhatMatters(summary));
  }
  notes.push_back(summary.motions == 1
                      ? "One motion: the intervals tell of noise only."
                      : fmt::format("{} motions are what repeats: the intervals hold for other "
                                    "motions of their kind.",
                                    summary.motions));
  if (const std::string whose = WhoseScatter(summary); !whose.empty()) notes.push_back(whose);
  return notes;
}

/// Who follows best at each cut-off; empty where the reference is no smoothed recording.
std::string SmoothingText(const FinishedStudy& finished) {
  if (finished.smoothing.empty() || finished.result.controller_names.size() < 2) return "";
  std::string best;
  for (const SmoothingRank& rank : finished.smoothing) {
    const auto least = std::ranges::min_element(rank.tracking_rmse_deg, [](double a, double b) {
      return a < b || (std::isnan(b) && !std::isnan(a));
    });
    const auto index = static_cast<std::size_t>(least - rank.tracking_rmse_deg.begin());
    if (std::isnan(*least)) return "";
    best += fmt::format("{}{:g} Hz {} ({:.2f} deg RMS)", best.empty() ? "" : ", ",
                        rank.smoothing_hz, finished.result.controller_names[index], *least);
  }
  return fmt::format(
      "The reference is the recording itself, smoothed, and nobody knows at which cut-off it is "
      "the "
      "wearer's motion. Who follows it best at{}: {}.",
      finished.study.repetitions.size() > 1 ? " (first recording)" : "", best);
}

}  // namespace

std::vector<std::string> Notes(const FinishedStudy& finished) {
  const Summary& summary = finished.summary;
  std::vector<std::string> notes =
      summary.one_run ? std::vector{ReasonForNoChance(finished.result)} : NotesOnChance(summary);
  for (const PredictionCeiling& ceiling : finished.ceilings) {
    notes.push_back(PredictionText(ceiling));
  }
  if (std::string smoothing = SmoothingText(finished); !smoothing.empty()) {
    notes.push_back(std::move(smoothing));
  }
  if (std::string overlap = DigitsInEachOther(summary); !overlap.empty()) {
    notes.push_back(std::move(overlap));
  }
  return notes;
}

std::string Verdict(const Summary& summary) {
  const std::size_t tracking = MetricIndex("tracking_rmse_deg");
  const std::size_t jitter = MetricIndex("jitter_rms_deg");
  const auto& all = summary.controllers;
  if (all.size() == 1) {
    if (all[0].rank[tracking] == 0 || all[0].rank[jitter] == 0) return "";
    return fmt::format("{} follows within {} deg RMS and shakes by {} deg RMS.", all[0].name,
                       Value(all[0], tracking), Value(all[0], jitter));
  }
  const Named named = WhomToName(summary);
  const auto& [follower, calm] = named;
  if (follower == nullptr || calm == nullptr) return "";
  if (summary.one_run) return VerdictOfOneRun(named, tracking, jitter);
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
  if (summary.baseline && follower != &all[*summary.baseline]) {
    const ControllerSummary& baseline = all[*summary.baseline];
    text += fmt::format("; {}: {} and {}", baseline.name, Value(baseline, tracking),
                        Value(baseline, jitter));
  }
  return text + "." + Costs(summary, *follower);
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

std::string DurationText(const StudyResult& result) {
  const std::string shortest = fmt::format("{:.1f}", result.shortest_s);
  const std::string longest = fmt::format("{:.1f}", result.longest_s);
  return shortest == longest ? longest + " s" : fmt::format("{} to {} s", shortest, longest);
}

std::string WhatVaries(const StudyResult& result) {
  std::map<int, int> seeds_of;  // motion -> how many seeds
  for (const SeedOutcome& seed : result.seeds) ++seeds_of[seed.motion];
  const std::size_t motions = seeds_of.size();
  const std::string moved = motions == 1 ? "one motion" : fmt::format("{} motions", motions);
  if (result.seeds_alike) return moved + ", nothing drawn at random";
  if (motions == 1) return fmt::format("{}, {} noises", moved, result.seeds.size());
  int fewest = std::ssize(result.seeds);
  int most = 0;
  for (const auto& [motion, seeds] : seeds_of) {
    fewest = std::min(fewest, seeds);
    most = std::max(most, seeds);
  }
  if (most == 1) return moved + ", one noise each";
  if (fewest == most) return fmt::format("{}, {} noises each", moved, most);
  return fmt::format("{}, {} to {} noises each", moved, fewest, most);
}

std::string Measured(const Study& study) {
  return fmt::format("{} of {} joints measured", study.measured_joint_names.size(),
                     study.joint_count);
}

ResultText ScoreText(const FinishedStudy& finished) {
  const StudyResult& result = finished.result;
  const Summary& summary = finished.summary;
  const Scenario& scenario = finished.study.scenario;
  const std::string seeds = summary.one_run
                                ? fmt::format("seed {}", result.seeds.front().seed)
                                : fmt::format("seeds {} to {}: {}", result.seeds.front().seed,
                                              result.seeds.back().seed, WhatVaries(result));
  ResultText text = {
      fmt::format("{}: {}\n{}, {}; {}; reference: {}", scenario.name, scenario.question,
                  DurationText(result), Measured(finished.study), seeds, result.reference_name),
      MeansTable(summary)};
  if (summary.pairs > 0) AddLine(Legend(summary), text);
  for (const std::string& failure : Failures(summary, result.seeds.size())) AddLine(failure, text);
  for (const std::string& missing : MissingSeeds(result, summary)) AddLine(missing, text);
  for (const std::string& note : Notes(finished)) AddLine(note, text);
  text.emplace_back(ErrorSplitTable(summary));
  text.emplace_back(Verdict(summary));
  return text;
}

}  // namespace gauntlet::sim
