#pragma once

#include <functional>
#include <string>
#include <vector>

#include "sim/score/statistics/statistics.h"
#include "sim/study/study_run.h"

namespace gauntlet::sim {

/// The share of the predictable part of a motion that a controller's prediction uses, at the glove
/// and without a hand. The error of each joint is
///
///     e(t) = what the controller asks for at t - the wearer's angle at t + horizon
///
/// and what is shown is the mean over joints of its RMS, mean and interval over the repetitions
/// [deg].
struct PredictionCeiling {
  std::string controller;
  double shortest_horizon_ms = 0.0;
  double longest_horizon_ms = 0.0;
  bool is_same_motion =
      false;                   // all repetitions have one motion: fitted to what they are judged on
  MeanInterval now;            // of the glove's angles as they are: no filter, no prediction
  MeanInterval ours;           // of the controller
  MeanInterval fitted;         // of weights of each channel's own past, fitted to the others
  MeanInterval fitted_to_all;  // of weights of all channels; NaN with one, or if not determined
  MeanInterval known;  // of the glove's angles if they were known so far ahead: its own errors
  /// Share of the way from `now` to `fitted` that `ours` goes, and to `fitted_to_all`. May be
  /// beyond 1 within its interval: weights that do not change are the best of their kind for
  /// motions like the others, and no limit of all kinds. NaN where they foresee next to nothing.
  MeanInterval used;
  MeanInterval used_of_all;
};

/// Measures every controller whose prediction has a horizon. The weights are those of a prediction
/// {kind: fitted_to_others, offset: true}: every repetition is measured with weights that were
/// fitted to all that have another motion; the first ones only, up to kMost_s of motion.
///
/// Nothing where there are less than two different repetitions. What cannot be fitted is a line for
/// `remark`, and not in the result. Deterministic. Errors: Cancelled.
std::vector<PredictionCeiling> MeasurePredictionCeilings(
    const Study& study, const StudyResult& result,
    const std::function<void(const std::string&)>& remark);

}  // namespace gauntlet::sim
