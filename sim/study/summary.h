#pragma once

#include <optional>
#include <string>
#include <vector>

#include "sim/study/statistics.h"
#include "sim/study/study.h"

namespace gauntlet::sim {

/// One controller over all seeds. Vectors of metrics follow Metrics().
struct ControllerSummary {
  std::string name;
  std::vector<MeanInterval> summary;
  /// Paired by seed; this and the next two are empty without a baseline, and for the baseline.
  std::vector<MeanInterval> difference_to_baseline;
  std::vector<double> effect_size;        // of that difference
  std::vector<bool> worse_than_baseline;  // the whole interval lies on the wrong side
  std::vector<int> rank;                  // 1 is the best of the controllers
  std::vector<bool> as_good_as_best;      // the best one, and those no worse beyond chance
  std::vector<std::vector<double>> rows;  // rows of ScoreRows x metrics, means
  std::string problem;                    // first problem of its hands; empty if all were well
};

struct Summary {
  std::vector<ControllerSummary> controllers;
  std::vector<bool> dominated;          // another shakes less and lags less
  std::optional<std::size_t> baseline;  // index of the controller that others are held against
  /// Of fewer than two different runs nothing is said that needs chance: no interval, nothing is
  /// called as good as the best, nothing worse than the baseline.
  bool one_run = true;
};

/// Deterministic: the resampling is fixed by the scenario's seed.
Summary Summarise(const Study& study, const StudyResult& result);

/// A study that has been run, with what is concluded from it.
struct FinishedStudy {
  Study study;
  StudyResult result;
  Summary summary;
  bool comparison = false;  // of several seeds, as asked; else one run
};

}  // namespace gauntlet::sim
