#include "sim/show/pages/score_table.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <utility>
#include <vector>

#include "sim/answers/compare/comparison_verdict.h"
#include "sim/score/delay.h"
#include "sim/score/statistics/result_cells.h"
#include "sim/show/pages/controller_rows.h"
#include "sim/show/pages/error_split_table.h"
#include "sim/study/prediction_fit.h"

namespace gauntlet::sim {
namespace {

ResultColumn ColumnOf(std::size_t metric) {
  return {std::string(Metrics()[metric].key), ScoreHeading(metric),
          std::string(Metrics()[metric].unit)};
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

/// True if several runs are compared with a baseline.
bool HasDifferences(const Summary& summary) {
  return summary.baseline && !summary.one_run && summary.controllers.size() > 1;
}

/// Cell of a controller's metric: its value, below it the difference to the baseline, or its own
/// interval where there is none.
ResultCell CellOf(const Summary& summary, std::size_t controller, std::size_t metric) {
  const ControllerSummary& own = summary.controllers[controller];
  const MeanInterval& mean = own.summary[metric];
  ResultCell cell(mean.mean);
  const auto add_line = [&cell](const std::string& text) {
    if (!text.empty()) cell.text += kBreak + text;
  };
  if (summary.one_run) return cell;
  if (!HasDifferences(summary)) {
    const MeanInterval shown = ShownInterval(mean, mean.mean);
    if (std::isfinite(shown.low)) add_line(fmt::format("±{}", Short(shown.high - shown.mean)));
    return cell;
  }
  cell.mark = summary.MarkOf(controller, metric);
  if (!own.to_baseline.empty()) {
    add_line(DifferenceText(ShownInterval(own.to_baseline[metric].difference, mean.mean)));
  }
  return cell;
}

ResultTable MeansTable(const Summary& summary) {
  ResultTable table{.columns = {{"name", "controller"}}};
  const std::vector<std::size_t> shown = DetailedMetrics(summary);
  for (const std::size_t metric : shown) table.columns.push_back(ColumnOf(metric));
  for (const auto& [c, name] : ControllerRows(summary)) {
    ResultRow& row = table.rows.emplace_back(ResultRow{name});
    for (const std::size_t metric : shown) {
      row.push_back(CellOf(summary, c, metric));
    }
  }
  return table;
}

/// Some scores of some controllers, with their roles in the verdict.
ResultTable TableOf(const Summary& summary, const std::vector<ControllerRow>& controllers,
                    const std::vector<std::size_t>& metrics) {
  ResultTable table{.columns = {{"name", "controller"}}};
  for (const std::size_t metric : metrics) table.columns.push_back(ColumnOf(metric));
  const std::vector<std::string>& roles = summary.answer.roles;
  const bool has_roles = std::ranges::any_of(roles, [](const auto& role) { return !role.empty(); });
  if (has_roles) table.columns.push_back(ForPeople("verdict").Words());
  for (const auto& [c, name] : controllers) {
    ResultRow& row = table.rows.emplace_back(ResultRow{name});
    for (const std::size_t metric : metrics) {
      row.emplace_back(summary.controllers[c].summary[metric].mean);
      row.back().mark = summary.MarkOf(c, metric);
    }
    if (has_roles) row.push_back(ResultCell::Text(roles[c]));
  }
  return table;
}

/// The primary scores, and the main metrics of motors and objects.
ResultTable AnswerTable(const Summary& summary) {
  std::vector<std::size_t> metrics = ShownMetrics(summary);
  std::erase_if(metrics, [](std::size_t metric) {
    return !IsPrimary(metric) && Metrics()[metric].part == ScoredPart::kJoint;
  });
  return TableOf(summary, ControllerRows(summary), metrics);
}

/// Scores of the table that are a mean over some of the seeds, as the others have none.
std::vector<std::string> MissingSeeds(const StudyResult& result, const Summary& summary) {
  std::vector<std::string> missing;
  const int seeds = result.seeds.size();
  if (!summary.blocks.empty()) return missing;  // blocks have all scores or none
  for (const ControllerSummary& controller : summary.controllers) {
    for (const std::size_t metric : ShownMetrics(summary)) {
      const int count = controller.summary[metric].count;
      if (count == 0 || count == seeds || controller.failed_trials > 0) continue;
      missing.push_back(
          fmt::format("{}: {} is the mean of {} of {} seeds; the others have no value",
                      controller.name, Metrics()[metric].name, count, seeds));
    }
  }
  return missing;
}

/// Why there is no interval, star or flag.
std::string ReasonForNoChance(const FinishedStudy& finished) {
  const StudyResult& result = finished.result;
  const RecordingBlocks& blocks = finished.summary.blocks;
  if (blocks.is_wanted) {
    return fmt::format(
        "The recording is too short: it gives confidence intervals from {:.0f} s on, and {:.1f} s "
        "were used. Use more of it (glove.motion.duration_s), a longer one or more recordings "
        "(files:).",
        std::ceil(blocks.plan.needed_s), blocks.duration_s);
  }
  if (result.seeds_alike) {
    return "The input is fixed, so one run was made. Add recordings (files:) for confidence "
           "intervals.";
  }
  if (const std::string name = FittedToOneGlove(finished.study); !name.empty()) {
    return fmt::format(
        "{} is calibrated to the glove of this seed, and other seeds are other "
        "gloves, so more seeds give no confidence interval.",
        name);
  }
  return "For a recommendation, run several seeds (gauntlet compare).";
}

/// "97 % between motions and 3 % between noise seeds", a mean over controllers; empty where it is
/// not known.
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
  return fmt::format("{:.0f} % between motions and {:.0f} % between noise seeds", percent,
                     100.0 - percent);
}

/// Origin of the scatter of tracking, and of that of its differences; empty where it is not known.
std::string WhoseScatter(const Summary& summary) {
  const std::size_t tracking = MetricIndex("tracking_rmse_deg");
  const std::string of_values =
      SharesText(summary, [&](const auto& c) { return c.summary[tracking]; });
  const std::string of_differences = SharesText(summary, [&](const auto& c) {
    return c.to_baseline.empty() ? MeanInterval{} : c.to_baseline[tracking].difference;
  });
  if (of_values.empty()) return "";
  std::string text = fmt::format("Variance of the tracking error: {}", of_values);
  if (!of_differences.empty()) text += fmt::format("; of its differences: {}", of_differences);
  return text + ".";
}

std::string WhatMatters(const Summary& summary) {
  std::string text;
  for (const std::size_t metric : DetailedMetrics(summary)) {
    const RelevantDifference& least = Metrics()[metric].relevant_difference;
    if (!text.empty()) text += ", ";
    text += std::string(Metrics()[metric].name);
    if (least.absolute > 0.0)
      text += fmt::format(" {:g} {}", least.absolute, Metrics()[metric].unit);
    if (least.absolute > 0.0 && least.relative > 0.0) text += " or";
    if (least.relative > 0.0) text += fmt::format(" {:g} %", 100.0 * least.relative);
  }
  return fmt::format("Smallest relevant differences: {} (gauntlet list metrics gives sources).",
                     text);
}

/// The joints that the means of delay_ms are over; empty if these are all joints that count.
std::string JointsWithDelay(const FinishedStudy& finished) {
  const std::size_t delay = MetricIndex("delay_ms");
  const std::vector<std::size_t>& joints = finished.study.rows.joints;
  std::ptrdiff_t fewest = std::ssize(joints);
  std::ptrdiff_t most = 0;
  for (const SeedOutcome& seed : finished.result.seeds) {
    const auto have_one = std::ranges::count_if(joints, [&](std::size_t row) {
      return std::ranges::all_of(seed.controllers, [&](const TrialOutcome& trial) {
        return !std::isfinite(trial.scores.summary[delay]) ||
               std::isfinite(trial.scores.channels[row][delay]);
      });
    });
    fewest = std::min(fewest, have_one);
    most = std::max(most, have_one);
  }
  if (fewest == std::ssize(joints)) return "";
  return fmt::format(
      "The delay is the mean of {}{} of {} joints. The others have no unique delay with some "
      "controller.",
      fewest, most == fewest ? "" : fmt::format(" to {}", most), joints.size());
}

/// Why some differences, or means without a baseline, are shown without an interval; else empty.
std::string TooFewText(const Summary& summary, std::size_t seeds) {
  for (const ControllerSummary& controller : summary.controllers) {
    for (const std::size_t metric : DetailedMetrics(summary)) {
      const MeanInterval& mean = controller.summary[metric];
      const MeanInterval& shown = HasDifferences(summary) && !controller.to_baseline.empty()
                                      ? controller.to_baseline[metric].difference
                                      : mean;
      if (IsOfTooFew(shown, mean.mean)) return TooFewText(shown, seeds);
    }
  }
  return "";
}

/// Sentences of a table of several seeds about chance.
std::vector<std::string> NotesOnChance(const Summary& summary, std::size_t seeds) {
  std::vector<std::string> notes;
  if (std::string few = TooFewText(summary, seeds); !few.empty()) notes.push_back(std::move(few));
  if (!HasDifferences(summary)) {
    notes.emplace_back("± 95 % confidence interval of the mean.");
  }
  if (summary.pairs > 0 && HasDifferences(summary)) {
    notes.push_back(fmt::format(
        "Second line: difference to {}, paired by {}, ± simultaneous 95 % "
        "confidence interval of the {} pairs in tracking error, delay and jitter, and of the {} "
        "pairs in all other scores (Bonferroni).",
        summary.controllers[*summary.baseline].name, summary.blocks.empty() ? "seed" : "block",
        summary.primary_pairs, summary.pairs - summary.primary_pairs));
  } else if (summary.pairs > 0) {
    notes.emplace_back("For marks and differences, name a controller: baseline: NAME.");
  }
  if (summary.pairs > 0) notes.push_back(WhatMatters(summary));
  if (!summary.blocks.empty()) {
    notes.push_back(fmt::format(
        "Replicates: {} of this recording, each left out in turn (jackknife). The errors are "
        "correlated over {:.1f} s.",
        summary.blocks.Text(), summary.blocks.plan.correlation_s));
  } else {
    notes.push_back(summary.motions == 1 ? "One motion: the confidence intervals cover noise only."
                                         : fmt::format("Replicates: {} motions.", summary.motions));
  }
  if (const std::string whose = WhoseScatter(summary); !whose.empty()) notes.push_back(whose);
  return notes;
}

/// Origin of the weights that the study fits; empty if there are none.
std::string WeightsLine(const Study& study) {
  std::vector<std::string_view> names;
  for (const NamedController& named : study.scenario.controllers) {
    if (std::holds_alternative<controller::FittedToOthersPredictionConfig>(
            named.config.prediction.settings)) {
      names.push_back(named.name);
    }
  }
  if (names.empty()) return "";
  const int others = MotionCount(study) - 1;
  return fmt::format("Weights of {}: fitted to the {} of this scenario.", fmt::join(names, ", "),
                     others == 1 ? "other motion" : fmt::format("{} other motions", others));
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
      "The true motion is unknown. Least tracking error for a reference smoothed at{}: {}.",
      finished.study.repetitions.size() > 1 ? " (first recording)" : "", best);
}

}  // namespace

std::string MarkLegend(const Summary& summary) {
  if (!HasDifferences(summary)) return "";
  return fmt::format("* better, = equivalent, ! worse, ? undecided (compared with {})",
                     summary.controllers[*summary.baseline].name);
}

std::vector<std::string> Notes(const FinishedStudy& finished) {
  const Summary& summary = finished.summary;
  std::vector<std::string> notes;
  if (!summary.one_run) notes = NotesOnChance(summary, finished.result.seeds.size());
  if (std::string joints = JointsWithDelay(finished); !joints.empty()) {
    notes.push_back(std::move(joints));
  }
  if (std::string smoothing = SmoothingText(finished); !smoothing.empty()) {
    notes.push_back(std::move(smoothing));
  }
  return notes;
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

std::string Measured(const Study& study, const StudyResult& result) {
  const Signal& reference_rad = result.first_reference_rad;
  const auto rests = [&](int joint) {
    TrimSignals();
    const auto angle_rad = reference_rad.col(joint).array();
    return std::sqrt((angle_rad - angle_rad.mean()).square().mean()) < kStillRms_rad;
  };
  const bool one_motion =
      std::ranges::all_of(result.seeds, [](const SeedOutcome& seed) { return seed.motion == 0; });
  const auto at_rest = one_motion && reference_rad.rows() > 0
                           ? std::ranges::count_if(study.measured_joints, rests)
                           : 0;
  return fmt::format("{} of {} joints{}", study.measured_joint_names.size(), study.joint_count,
                     at_rest == 0 ? "" : fmt::format(", {} of them at rest", at_rest));
}

void AddAnswerNotes(const FinishedStudy& finished, ResultText& text) {
  const Summary& summary = finished.summary;
  AddLine(CausesText(summary), text);
  AddLine(WeightsLine(finished.study), text);
  for (const std::string& missing : MissingSeeds(finished.result, summary)) AddLine(missing, text);
  for (const std::string& doubt : summary.answer.verdict.Doubts())
    AddLine("Warning: " + doubt, text);
}

ResultText AnswerText(const FinishedStudy& finished) {
  ResultText text = {AnswerTable(finished.summary)};
  AddLine(MarkLegend(finished.summary), text);
  return text;
}

ResultText ShownText(const FinishedStudy& finished) {
  const Summary& summary = finished.summary;
  const std::vector<std::size_t>& shown = summary.answer.shown;
  std::vector<ControllerRow> rows = ControllerRows(summary);
  std::erase_if(rows, [&](const ControllerRow& row) {
    return std::ranges::count(shown, row.controller) == 0;
  });
  std::stable_partition(rows.begin(), rows.end(), [&](const ControllerRow& row) {
    return row.controller != summary.baseline;
  });
  std::vector<std::size_t> metrics = ShownMetrics(summary);
  std::erase_if(metrics, [](std::size_t metric) { return !IsPrimary(metric); });
  ResultText text = {TableOf(summary, rows, metrics)};
  AddLine(MarkLegend(summary), text);
  return text;
}

ResultText ScoreText(const FinishedStudy& finished, bool verbose) {
  const StudyResult& result = finished.result;
  const Summary& summary = finished.summary;
  const Scenario& scenario = finished.study.scenario;
  const std::string seeds = !summary.blocks.empty() ? summary.blocks.Text()
                            : summary.one_run
                                ? fmt::format("seed {}", result.seeds.front().seed)
                                : fmt::format("seeds {} to {}: {}", result.seeds.front().seed,
                                              result.seeds.back().seed, WhatVaries(result));
  ResultText text = {fmt::format("{}: {}\n{}, {}; {}; reference: {}", scenario.name,
                                 scenario.question, DurationText(result),
                                 Measured(finished.study, result), seeds, result.reference_name)};
  text.emplace_back(std::string());
  for (const std::string& sentence : summary.answer.verdict.Answer()) AddLine(sentence, text);
  if (summary.one_run) AddLine(ReasonForNoChance(finished), text);
  for (const std::string& failure : Failures(summary, result.seeds.size())) AddLine(failure, text);
  std::ranges::move(AnswerText(finished), std::back_inserter(text));
  AddAnswerNotes(finished, text);
  if (!verbose) return text;
  text.emplace_back(MeansTable(summary));
  for (const std::string& note : Notes(finished)) AddLine(note, text);
  text.emplace_back(SwitchedTable(summary));
  text.emplace_back(ErrorSplitTable(summary));
  AddLine(SharesNote(summary), text);
  return text;
}

}  // namespace gauntlet::sim
