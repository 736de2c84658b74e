#pragma once

#include <span>
#include <vector>

#include "sim/base/signal.h"
#include "sim/score/counted_ticks.h"
#include "sim/show/video/frame_clock.h"

namespace gauntlet::sim {

/// Two scores of one pane as they stand at each frame, over everything shown so far; at the last
/// frame they are the scores of the table. NaN where there is none yet.
///
///     rmse   = mean over channels of sqrt(mean over samples of (hand - true)^2)
///     jitter = mean over channels of sqrt(mean over samples of (hand above the edge)^2)
///
/// Samples that count, and channels that have any by then: as in the table, unknown parts of a
/// recording are left out.
///
/// The jitter's high pass is the score's own (sim/score/jitter.h): near either end (0.63 s for 10
/// Hz) it has no value.
struct RunningScores {
  std::vector<double> tracking_rmse_deg;  // per frame
  std::vector<double> jitter_rms_deg;     // per frame
};

/// Shapes: both samples x channels; the hand may have fewer samples (a stopped trial). `counted`:
/// per channel, in samples; none: all count.
RunningScores ComputeRunningScores(const Signal& true_angle_rad, const Signal& hand_angle_rad,
                                   double rate_hz, double jitter_above_hz, const FrameClock& clock,
                                   std::span<const CountedTicks> counted = {});

}  // namespace gauntlet::sim
