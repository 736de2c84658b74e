#include "sim/answers/tune/tune_split.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "sim/answers/compare/recording_blocks.h"
#include "sim/answers/tune/tune.h"
#include "sim/base/error.h"
#include "sim/score/statistics/blocks.h"
#include "sim/study/repeats.h"
#include "sim/study/study.h"
#include "sim/study/study_run.h"

namespace gauntlet::sim {
namespace {

constexpr int kFewestHeldOut =
    4;  // recordings or blocks: a confidence interval of fewer is too wide
constexpr int kFewestRecordings = 2 * kFewestHeldOut;

std::string Numbered(const std::string& one, const std::string& many, int first, int count) {
  return count == 1 ? fmt::format("{} {}", one, first)
                    : fmt::format("{} {} to {}", many, first, first + count - 1);
}

/// The controller of the plan as the scenario has it, with the repetition of a seed as the first.
Study StudyOfController(const TunePlan& plan, int seed) {
  ScenarioSource source = plan.scenario;
  source.overrides.push_back(fmt::format("seed={}", seed));
  Scenario scenario = ParseScenario(source);
  KeepControllers({plan.controller}, scenario);
  scenario.baseline.clear();
  return PrepareStudy(std::move(scenario));
}

/// The time that counts in each repetition.
std::vector<CountedTime> TimesOf(const TunePlan& plan, const Study& first, int jobs) {
  std::vector<CountedTime> times;
  for (std::size_t i = 0; i < first.repetitions.size(); ++i) {
    const Study study =
        i == 0 ? first : StudyOfController(plan, first.scenario.seed + static_cast<int>(i));
    const StudyResult result = RunStudy(study, {.seeds = 1,
                                                .jobs = jobs,
                                                .physics = plan.physics,
                                                .scores = {MetricIndex("tracking_rmse_deg")}});
    const HandHealth& health = result.seeds.front().controllers.front().health;
    if (!health.ok) throw RunError(plan.controller + ": " + health.problem);
    times.push_back(CountedTimeOf(study, result));
  }
  return times;
}

std::string TooShort(const CountedTime& time, double needed_s, bool single) {
  return fmt::format(
      "{} recording is too short to tune on one part and to validate on another: {:.0f} s are "
      "needed, and {:.1f} s can be scored. Use more of it (glove.motion.duration_s), a longer one, "
      "or at least {} recordings (files:)",
      single ? "the" : "a", std::ceil(needed_s), time.duration_s, kFewestRecordings);
}

void DivideByTime(const TunePlan& plan, const Study& study, int jobs, TuneSplit& split) {
  const std::size_t repetitions = study.repetitions.size();
  const std::vector<CountedTime> times = TimesOf(plan, study, jobs);
  const double correlation_s =
      std::ranges::max(times, {}, &CountedTime::correlation_s).correlation_s;
  const bool single = repetitions == 1;
  for (std::size_t i = 0; i < repetitions; ++i) {
    const BlockPlan blocks =
        PlanBlocks(times[i].duration_s, correlation_s, single ? kFewestBlocks : kFewestHeldOut);
    if (blocks.count == 0) throw RunError(TooShort(times[i], blocks.needed_s, single));
    const std::vector<TickRange> all = DivideTicks(times[i], blocks.count);
    const auto half = all.begin() + blocks.count / 2;
    const auto same = std::ranges::find(study.repetitions, study.repetitions[i].motion_hash,
                                        &GloveFacts::motion_hash);
    split.divided.push_back({.number = static_cast<int>(same - study.repetitions.begin()),
                             .fitted = {all.begin(), half},
                             .held_out = {half, all.end()},
                             .length_s = blocks.length_s,
                             .widening = blocks.Widening()});
  }
}

}  // namespace

int TuneSplit::BlocksOf(TunePart part) const {
  int count = 0;
  for (std::size_t i = 0; i < divided.size(); ++i) {
    if (divided[i].number != static_cast<int>(i)) continue;  // of a motion that is there already
    const auto& blocks = part == TunePart::kFitted ? divided[i].fitted : divided[i].held_out;
    count += static_cast<int>(blocks.size());
  }
  return count;
}

std::string TuneSplit::Noun() const {
  constexpr const char* kNouns[] = {"seeds", "recordings", "blocks"};
  return kNouns[static_cast<std::size_t>(by)];
}

std::string TuneSplit::Text(TunePart part) const {
  const bool is_held_out = part == TunePart::kHeldOut;
  const std::string prefix = is_held_out ? "held-out " : "";
  if (is_fixed) return is_held_out ? "nothing" : "one run, as the input is fixed";
  const int first = is_held_out ? fitted : 0;
  const int count = is_held_out ? held_out : fitted;
  switch (by) {
    case By::kRecordings:
      return prefix + Numbered("recording", "recordings", first + 1, count) +
             (is_held_out ? fmt::format(" of {}", recordings) : "");
    case By::kBlocks: {
      const int blocks = BlocksOf(part);
      if (recordings > 1) {
        return fmt::format("{} {}blocks, the {} half of each of {} recordings", blocks, prefix,
                           is_held_out ? "second" : "first", recordings);
      }
      return prefix +
             Numbered("block", "blocks", is_held_out ? BlocksOf(TunePart::kFitted) + 1 : 1,
                      blocks) +
             (is_held_out
                  ? fmt::format(" of this recording ({:.1f} s each)", divided.front().length_s)
                  : "");
    }
    default:
      return prefix + Numbered("seed", "seeds", first_seed + first, count);
  }
}

std::string TuneSplit::Cure() const {
  if (is_fixed) return "Recordings (files:) can decide it.";
  switch (by) {
    case By::kRecordings:
      return "More recordings can decide it.";
    case By::kBlocks:
      return recordings > 1 ? "Longer or more recordings can decide it."
                            : "A longer recording, or several, can decide it.";
    default:
      return "More seeds can decide it.";
  }
}

TuneSplit SplitOf(const TunePlan& plan, int jobs) {
  TuneSplit split{.first_seed = ParseScenario(plan.scenario).seed,
                  .fitted = plan.seeds,
                  .held_out = plan.held_out};
  const Study study = StudyOfController(plan, split.first_seed);
  const int repetitions = static_cast<int>(study.repetitions.size());
  const auto is_alike = [&] { return Repeats(study, 2 * repetitions).alike(); };
  const bool has_recordings = std::ranges::any_of(study.repetitions, &GloveFacts::is_of_recording);
  if (!has_recordings) {
    RefuseOtherGloves(study, plan.seeds + plan.held_out);
    split.is_fixed = plan.seeds + plan.held_out > repetitions && is_alike();
    return split;
  }
  std::vector<std::string> motions;
  for (const GloveFacts& facts : study.repetitions) motions.push_back(facts.motion_hash);
  std::ranges::sort(motions);
  split.recordings =
      static_cast<int>(std::unique(motions.begin(), motions.end()) - motions.begin());
  const bool all_differ = split.recordings == repetitions;
  if (all_differ && plan.seeds + plan.held_out <= repetitions) {
    split.by = TuneSplit::By::kRecordings;
  } else if (all_differ && repetitions >= kFewestRecordings) {
    split.by = TuneSplit::By::kRecordings;
    const double share = static_cast<double>(plan.seeds) / (plan.seeds + plan.held_out);
    split.fitted = std::clamp(static_cast<int>(repetitions * share), kFewestHeldOut,
                              repetitions - kFewestHeldOut);
    split.held_out = repetitions - split.fitted;
  } else {
    split.by = TuneSplit::By::kBlocks;
    // Whole rounds, so that both parts begin with the same recording.
    const int rounds_at_most = is_alike() ? 1 : std::max(plan.seeds, plan.held_out);
    const auto rounded = [&](int seeds) {
      return repetitions * std::min(rounds_at_most, (seeds + repetitions - 1) / repetitions);
    };
    split.fitted = rounded(plan.seeds);
    split.held_out = rounded(plan.held_out);
    DivideByTime(plan, study, jobs, split);
  }
  return split;
}

}  // namespace gauntlet::sim
