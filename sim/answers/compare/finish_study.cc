#include "sim/answers/compare/finish_study.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <variant>

#include "sim/base/error.h"
#include "sim/results/table_text.h"
#include "sim/score/no_score.h"
#include "sim/study/trial_score.h"
#include "sim/study/trial_table/awaited_trials.h"
#include "sim/study/trial_table/study_database.h"
#include "sim/study/trial_table/trial_table.h"
#include "sim/trial/joint_angles.h"

namespace gauntlet::sim {
namespace {

void Tell(const std::function<void(const std::string&)>& hearer, const std::string& line) {
  if (hearer) hearer(line);
}

StudyResult RunTrials(const Study& study, const StudyWork& work, TrialStore* store) {
  std::optional<AwaitedTrials> awaited;
  if (work.elsewhere != nullptr) {
    store = &awaited.emplace(study, work.seeds, *work.elsewhere, store);
  }
  return RunStudy(study, {.seeds = work.seeds,
                          .jobs = work.jobs,
                          .progress = work.progress,
                          .remark = work.remark,
                          .keep_first_traces = true,
                          .traces_go = work.traces_go,
                          .causes = work.causes,
                          .store = store});
}

/// Runs the trials and keeps them in study.db as they finish; `not_kept` tells what it lacks in the
/// end, if anything.
StudyResult RunKeptTrials(const FinishedStudy& finished, const StudyWork& work,
                          std::optional<std::string>& not_kept) {
  const std::filesystem::path file = finished.folder / "study.db";
  StudyDatabase database(file, finished.study, {.seeds = work.seeds});
  if (const int known = database.TrialCount(); known > 0) {
    Tell(work.note,
         fmt::format("continues from {} with {}", file.string(), Counted(known, "trial")));
  }
  if (const int damaged = database.DamagedCount(); damaged > 0) {
    Tell(work.remark,
         fmt::format("{}: {} damaged, computed again", file.string(), Counted(damaged, "trial")));
  }
  try {
    StudyResult result = RunTrials(finished.study, work, &database);
    not_kept = database.Finish();
    return result;
  } catch (const Cancelled&) {
    not_kept = database.Finish();
    const int known = database.TrialCount();
    if (known == 0) throw;
    throw Cancelled{
        fmt::format("{} {} {}", Counted(known, "trial"), known == 1 ? "is" : "are", KeptIn(file))};
  }
}

/// At 0.5, 1, 2 and 5 Hz, of the first seed's trials. Nothing where the reference is no smoothed
/// recording, or the traces were not kept. Deterministic.
std::vector<SmoothingRank> RankBySmoothing(const Study& study, const StudyResult& result) {
  const int seed = study.scenario.seed;
  GloveConfig config = GloveOf(study.scenario, seed);
  auto* recording = std::get_if<RecordedMotionConfig>(&config.motion.settings);
  const bool is_smoothed = recording != nullptr && recording->use == RecordingUse::kMeasured &&
                           recording->reference.empty();
  if (!is_smoothed || result.first_traces.empty()) return {};
  const std::size_t tracking = MetricIndex("tracking_rmse_deg");
  const std::size_t wanted[] = {tracking};
  std::vector<SmoothingRank> ranks;
  for (const double smoothing_hz : {0.5, 1.0, 2.0, 5.0}) {
    recording->smoothing_hz = smoothing_hz;
    const GloveSignal glove = SynthesiseGlove(config, static_cast<std::uint64_t>(seed));
    const Signal reference_rad = ReferenceAngles(study.joint_map(), glove.true_angle_rad);
    SmoothingRank& rank = ranks.emplace_back();
    rank.smoothing_hz = smoothing_hz;
    for (std::size_t c = 0; c < result.first_traces.size(); ++c) {
      const Trace& trace = result.first_traces[c];
      rank.tracking_rmse_deg.push_back(trace.health.ok
                                           ? ScoreTrial(study, study.scenario.controllers[c].config,
                                                        glove, reference_rad, trace, {}, wanted)
                                                 .summary[tracking]
                                           : kNoScore);
    }
  }
  return ranks;
}

}  // namespace

int SeedsOfComparison(const Scenario& scenario) {
  constexpr int kFewest = 8;
  return std::max(kFewest, static_cast<int>(scenario.repetitions.gloves.size()));
}

double EstimateSeconds(const Study& study, const StudyWork& work) {
  Study piece = study;
  auto& controllers = piece.scenario.controllers;
  controllers.resize(std::min(controllers.size(), static_cast<std::size_t>(work.jobs)));
  const auto start = std::chrono::steady_clock::now();
  RunStudy(piece, {.jobs = work.jobs,
                   .progress = [&](double, int) { return !work.progress || work.progress(0.0, 1); },
                   .causes = CauseSeeds::kNone});
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
  return took.count() * TrialCount(study, work.seeds, work.causes) /
         TrialCount(piece, 1, CauseSeeds::kNone);
}

std::optional<std::string> FinishStudy(const StudyWork& work, FinishedStudy& finished) {
  std::optional<std::string> not_kept;
  finished.result = finished.comparison && !finished.folder.empty()
                        ? RunKeptTrials(finished, work, not_kept)
                        : RunTrials(finished.study, work, nullptr);
  finished.summary =
      Summarise(finished.study, finished.result,
                finished.comparison ? DivideRecording(finished.study, finished.result, work.jobs)
                                    : RecordingBlocks());
  finished.smoothing = RankBySmoothing(finished.study, finished.result);
  return not_kept;
}

}  // namespace gauntlet::sim
