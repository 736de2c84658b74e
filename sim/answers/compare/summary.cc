#include "sim/answers/compare/summary.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "sim/answers/compare/comparison_verdict.h"
#include "sim/results/table_text.h"

namespace gauntlet::sim {
namespace {

/// Mark of a remark about what the map of a recording assumes: see AssumptionsOf().
constexpr std::string_view kAssumed = ": assumed: ";

std::vector<std::vector<double>> RowMeans(const StudyResult& result, std::size_t controller) {
  const std::vector<int> motions = MotionsOf(result);
  std::vector<std::vector<double>> means;
  for (std::size_t c = 0; c < result.row_names.size(); ++c) {
    std::vector<double>& row = means.emplace_back();
    for (std::size_t m = 0; m < Metrics().size(); ++m) {
      std::vector<double> values;
      for (const SeedOutcome& seed : result.seeds) {
        values.push_back(seed.controllers[controller].scores.channels[c][m]);
      }
      row.push_back(EstimateMean(values, motions).mean);
    }
  }
  return means;
}

/// Values of the replicates: of the blocks of a recording, or of the seeds.
std::vector<double> ReplicateValues(const StudyResult& result, const RecordingBlocks& blocks,
                                    std::size_t controller, std::size_t metric) {
  const bool has_blocks = !blocks.empty() && !blocks.values[controller][metric].empty();
  return has_blocks ? blocks.values[controller][metric] : SeedValues(result, controller, metric);
}

/// The motion of each replicate; none of blocks, which share it.
std::vector<int> MotionsOfReplicates(const StudyResult& result, const RecordingBlocks& blocks) {
  return blocks.empty() ? MotionsOf(result) : std::vector<int>();
}

void FindFailures(const StudyResult& result, std::size_t controller, ControllerSummary& summary) {
  for (const SeedOutcome& seed : result.seeds) {
    const HandHealth& health = seed.controllers[controller].health;
    if (health.ok) continue;
    if (++summary.failed_trials == 1) {
      summary.problem = fmt::format("{} (seed {})", health.problem, seed.seed);
    }
  }
}

/// A score that can be compared: of a controller all of whose trials went well.
bool HasScore(const ControllerSummary& controller, std::size_t metric) {
  return controller.failed_trials == 0 && std::isfinite(controller.summary[metric].mean);
}

/// The second against the first, from the first against the second.
Comparison Reversed(Comparison comparison) {
  MeanInterval& difference = comparison.difference;
  difference.mean = -difference.mean;
  std::swap(difference.low, difference.high);
  difference.low = -difference.low;
  difference.high = -difference.high;
  if (comparison.judgement == Judgement::kBetter) {
    comparison.judgement = Judgement::kWorse;
  } else if (comparison.judgement == Judgement::kWorse) {
    comparison.judgement = Judgement::kBetter;
  }
  return comparison;
}

/// Judges all pairs of controllers in the metrics of one family. Returns how many have an interval.
int JudgeFamily(const StudyResult& result, bool primary, Summary& summary) {
  const std::vector<int> motions = MotionsOfReplicates(result, summary.blocks);
  const std::size_t controllers = summary.controllers.size();
  std::vector<Question> questions;
  std::vector<std::pair<std::size_t, std::size_t>> places;  // there and back
  for (std::size_t m = 0; m < Metrics().size(); ++m) {
    if (IsPrimary(m) != primary) continue;
    for (std::size_t first = 0; first < controllers; ++first) {
      for (std::size_t second = 0; second < first; ++second) {
        const ControllerSummary& a = summary.controllers[first];
        const ControllerSummary& b = summary.controllers[second];
        if (!HasScore(a, m) || !HasScore(b, m)) continue;
        places.emplace_back(summary.Place(m, first, second), summary.Place(m, second, first));
        questions.push_back({.difference = EstimateDifference(
                                 ReplicateValues(result, summary.blocks, first, m),
                                 ReplicateValues(result, summary.blocks, second, m), motions),
                             .relevant_difference = RelevantDifferenceBetween(
                                 Metrics()[m], a.summary[m].mean, b.summary[m].mean),
                             .lower_is_better = Metrics()[m].lower_is_better});
      }
    }
  }
  int pairs = 0;
  std::vector<Comparison> answers = Judge(questions);
  for (std::size_t i = 0; i < answers.size(); ++i) {
    const bool has_interval = std::isfinite(answers[i].difference.low);
    const bool needs_interval = summary.one_run || !summary.blocks.empty();
    if (needs_interval && !has_interval) answers[i].judgement = Judgement::kNone;
    if (has_interval) ++pairs;
    summary.comparisons[places[i].first] = answers[i];
    summary.comparisons[places[i].second] = Reversed(answers[i]);
  }
  return pairs;
}

void JudgePairs(const StudyResult& result, Summary& summary) {
  const std::size_t controllers = summary.controllers.size();
  summary.comparisons.resize(Metrics().size() * controllers * controllers);
  summary.primary_pairs = JudgeFamily(result, true, summary);
  summary.pairs = summary.primary_pairs + JudgeFamily(result, false, summary);
}

void CompareWithBaseline(const StudyResult& result, std::size_t metric, Summary& summary) {
  if (!summary.baseline) return;
  for (std::size_t c = 0; c < summary.controllers.size(); ++c) {
    if (c == *summary.baseline) continue;
    ControllerSummary& controller = summary.controllers[c];
    controller.to_baseline.push_back(summary.Of(metric, c, *summary.baseline));
    controller.effect_size.push_back(
        PairedEffectSize(ReplicateValues(result, summary.blocks, c, metric),
                         ReplicateValues(result, summary.blocks, *summary.baseline, metric)));
  }
}

}  // namespace

char Summary::MarkOf(std::size_t controller, std::size_t metric) const {
  static constexpr std::string_view kMarks = " *=?!";  // in the order of Judgement
  return kMarks[static_cast<std::size_t>(controllers[controller].AgainstBaseline(metric))];
}

std::vector<int> MotionsOf(const StudyResult& result) {
  std::vector<int> motions;
  for (const SeedOutcome& seed : result.seeds) motions.push_back(seed.motion);
  return motions;
}

std::vector<double> SeedValues(const StudyResult& result, std::size_t controller,
                               std::size_t metric) {
  std::vector<double> values;
  for (const SeedOutcome& seed : result.seeds) {
    values.push_back(seed.controllers[controller].scores.summary[metric]);
  }
  return values;
}

std::string PartOfCauses(const Summary& summary) {
  const CausePlan& plan = summary.causes;
  const bool of_several = !summary.one_run && summary.blocks.empty() && plan.seeds == 1;
  std::string seed = of_several ? "first seed" : "";
  if (!plan.stretch_s) return seed;
  return fmt::format("first {:g} s{}{}", *plan.stretch_s, of_several ? " of the " : "", seed);
}

Summary Summarise(const Study& study, const StudyResult& result, RecordingBlocks blocks) {
  Summary summary;
  summary.blocks = std::move(blocks);
  summary.priority = ParsePriority(study.scenario.priority);
  for (const std::string& remark : study.remarks) {
    const std::size_t place = remark.find(kAssumed);
    if (place == std::string::npos) continue;
    // The name of the file, not its folders.
    const std::string name = std::filesystem::path(remark.substr(0, place)).filename().string();
    summary.assumed.push_back(name + remark.substr(place) + ".");
  }
  summary.causes = result.causes;
  for (std::size_t m = 0; m < Metrics().size(); ++m) {
    summary.no_value.push_back(
        WhyNoValue(m, study.scenario.score.jitter_above_hz, result.longest_s));
  }
  summary.baseline = BaselineOf(study.scenario);
  summary.one_run = result.seeds.size() < 2 && summary.blocks.empty();
  const std::vector<int> motions = MotionsOf(result);
  summary.motions = static_cast<int>(std::set(motions.begin(), motions.end()).size());
  const std::vector<int> of_replicates = MotionsOfReplicates(result, summary.blocks);
  for (std::size_t c = 0; c < result.controller_names.size(); ++c) {
    ControllerSummary& controller = summary.controllers.emplace_back();
    controller.name = result.controller_names[c];
    FindFailures(result, c, controller);
    controller.rows = RowMeans(result, c);
    for (std::size_t m = 0; m < Metrics().size(); ++m) {
      controller.summary.push_back(
          EstimateMean(ReplicateValues(result, summary.blocks, c, m), of_replicates).IntervalAt());
    }
  }
  JudgePairs(result, summary);
  for (std::size_t m = 0; m < Metrics().size(); ++m) {
    CompareWithBaseline(result, m, summary);
    for (ControllerSummary& controller : summary.controllers) {
      controller.has_score.push_back(HasScore(controller, m));
    }
  }
  summary.answer = AnswerOf(summary);
  return summary;
}

std::vector<std::string> Failures(const Summary& summary, std::size_t seeds) {
  std::vector<std::string> lines;
  for (const ControllerSummary& controller : summary.controllers) {
    if (controller.failed_trials == 0) continue;
    lines.push_back(fmt::format(
        "{} failed in {} of {} and is not ranked: {}", controller.name, controller.failed_trials,
        Counted(static_cast<std::int64_t>(seeds), "trial"), controller.problem));
  }
  return lines;
}

}  // namespace gauntlet::sim
