#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include "controller/controller_config.h"
#include "sim/base/signal.h"
#include "sim/hand/hand_model.h"
#include "sim/score/score.h"

namespace gauntlet::sim {

/// Scores of the angles that a controller asks of the joints, as those of gauntlet run are of the
/// hand: means over the joints that count. NaN for one without a value.
struct TargetScores {
  double jitter_rms_deg = 0.0;
  double delay_ms = 0.0;
  double tracking_rmse_deg = 0.0;
};

/// Everything that the controllers of a session have in common.
struct TargetScoring {
  double rate_hz = 1000.0;  // of ticks
  double jitter_above_hz = ScoreConfig{}.jitter_above_hz;
  std::vector<int> joints;  // of the hand, that count
};

/// Angles that a controller asked of one joint. Shapes: ticks x 1. Units: rad.
struct AskedAngle {
  Signal reference_rad;
  Signal asked_rad;
  CountedTicks counted;
};

/// One controller.
struct AskingController {
  std::function<AskedAngle(std::size_t)> joint;  // by its place in TargetScoring::joints
  double earliest_delay_s = 0.0;                 // see EarliestAskedDelay_s()
};

/// Pure: the same signals give the same scores. One joint after the other, which takes little
/// memory beside a running session. The joints of a mean are the same for all controllers, see
/// UseCommonParts().
std::vector<TargetScores> ScoreTargets(const TargetScoring& scoring,
                                       std::span<const AskingController> controllers);

/// By how much the angles of a controller are late at least: ahead by the horizon of its
/// prediction. The way to the hand's motors is not in it.
double EarliestAskedDelay_s(const HandModel& hand, const controller::ControllerConfig& controller);

}  // namespace gauntlet::sim
