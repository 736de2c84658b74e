#pragma once

#include "controller/settings.h"

namespace gauntlet::controller {

enum class PredictionKind { kNone, kLinear, kKalman };

/// Looking ahead, to make up for the delay between the glove and the hand: the paper's second idea.
///
/// kLinear: the newest value plus horizon times the slope of the last `window_ms` (least squares).
/// kKalman: position plus horizon times velocity of a Kalman filter with white acceleration of
///          density q and measurement variance r, at its settled gain.
///
/// It pays while frequency x horizon stays below 0.1 to 0.2; above, it overshoots; and it raises
/// noise. Source: Bai, Jiang, Yokoi, section 5; defaults of kKalman are assumptions that fit
/// motions of 0.5 to 1 Hz and 45 deg.
struct PredictionConfig {
  PredictionKind kind = PredictionKind::kNone;
  double horizon_ms = 45.0;  // the paper's bound of the event time
  double window_ms = 60.0;
  double q_deg2_per_s3 = 1e4;
  double r_deg2 = 0.5;

  void Visit(SettingsVisitor& visitor);
};

}  // namespace gauntlet::controller
