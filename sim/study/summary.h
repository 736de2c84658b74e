#pragma once

#include <string>
#include <vector>

#include "sim/study/statistics.h"
#include "sim/study/study.h"

namespace gauntlet::sim {

/// One controller over all seeds. Vectors of metrics follow Metrics().
struct ControllerSummary {
  std::string name;
  std::vector<MeanInterval> summary;
  /// Paired by seed; empty if there is no raw controller.
  std::vector<MeanInterval> difference_to_raw;
  std::vector<double> effect_size;            // of that difference; empty likewise
  std::vector<bool> worse_than_raw;           // the whole interval lies on the wrong side
  std::vector<int> rank;                      // 1 is the best of the controllers
  std::vector<bool> as_good_as_best;          // the best one, and those no worse beyond chance
  std::vector<std::vector<double>> channels;  // channels x metrics, means
  std::string problem;                        // first problem of its hands; empty if all were well
};

struct Summary {
  std::vector<ControllerSummary> controllers;
  std::vector<bool> dominated;  // another shakes less and lags less
  int raw = -1;                 // index of the controller without a filter, -1 if there is none
};

/// Deterministic: the resampling is fixed by the scenario's seed.
Summary Summarise(const Study& study, const StudyResult& result);

}  // namespace gauntlet::sim
