#pragma once

#include <functional>
#include <optional>
#include <string>

#include "sim/answers/compare/summary.h"

namespace gauntlet::sim {

/// How the trials of a run or comparison are run.
struct StudyWork {
  int seeds = 1;
  int jobs = 1;
  CauseSeeds causes = CauseSeeds::kAuto;
  bool traces_go = false;                             // see StudyOptions
  std::function<bool(double, int)> progress = {};     // see StudyOptions
  std::function<void(const std::string&)> note = {};  // a line about trials that are known already
  std::function<void(const std::string&)> remark = {};  // see StudyOptions
  Elsewhere* elsewhere = nullptr;  // for the trials of a comparison; null: all are run here
};

/// The seeds of a comparison that names no number: 8, or one of each repetition where there are
/// more.
int SeedsOfComparison(const Scenario& scenario);

/// Seconds that all trials of `work` will take here, from a measured piece of them: the first
/// trials of as many controllers as run at a time. Trials that study.db knows already count as
/// well, and what follows the trials (tables, page, video) does not. Errors: as RunStudy();
/// Cancelled where `work.progress` returns false.
double EstimateSeconds(const Study& study, const StudyWork& work);

/// Runs the trials of `finished.study` and computes all else that its files contain. A comparison
/// with a folder keeps finished trials in its study.db, and takes those that are there.
/// Returns what study.db lacks, if anything. Errors: RunError; Cancelled, which says what is kept.
std::optional<std::string> FinishStudy(const StudyWork& work, FinishedStudy& finished);

}  // namespace gauntlet::sim
