#include "sim/answers/compare/finish_study.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "sim/base/error.h"
#include "sim/study/trial_table/study_database.h"
#include "sim/study/trial_table/trial_table.h"

namespace gauntlet::sim {
namespace {

void Tell(const std::function<void(const std::string&)>& hearer, const std::string& line) {
  if (hearer) hearer(line);
}

StudyResult RunTrials(const Study& study, const StudyWork& work, TrialStore* store) {
  return RunStudy(study, {.seeds = work.seeds,
                          .jobs = work.jobs,
                          .progress = work.progress,
                          .remark = work.remark,
                          .keep_first_traces = true,
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
    Tell(work.note, fmt::format("continues from {} with {}", file.string(), TrialsText(known)));
  }
  if (const int damaged = database.DamagedCount(); damaged > 0) {
    Tell(work.remark,
         fmt::format("{}: {} damaged, computed again", file.string(), TrialsText(damaged)));
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
        fmt::format("{} {} {}", TrialsText(known), known == 1 ? "is" : "are", KeptIn(file))};
  }
}

}  // namespace

int SeedsOfComparison(const Scenario& scenario) {
  constexpr int kFewest = 8;
  return std::max(kFewest, static_cast<int>(scenario.repetitions.gloves.size()));
}

std::string TrialsText(int count) {
  return fmt::format("{} trial{}", count, count == 1 ? "" : "s");
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
