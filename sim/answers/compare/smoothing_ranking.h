#pragma once

#include <vector>

#include "sim/study/study_run.h"

namespace gauntlet::sim {

/// Tracking of the controllers if the reference is the recording, smoothed at another cut-off. The
/// true cut-off is unknown, and the winner may depend on it.
struct SmoothingRank {
  double smoothing_hz = 0.0;
  std::vector<double> tracking_rmse_deg;  // per controller; NaN of one that was stopped
};

/// At 0.5, 1, 2 and 5 Hz, of the first seed's trials. Nothing where the reference is no smoothed
/// recording, or the traces were not kept. Deterministic.
std::vector<SmoothingRank> RankBySmoothing(const Study& study, const StudyResult& result);

}  // namespace gauntlet::sim
