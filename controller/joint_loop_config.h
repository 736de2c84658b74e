#pragma once

#include <vector>

#include "controller/export.h"
#include "controller/settings.h"

namespace gauntlet::controller {

enum class JointLoopKind { kNone, kPi };

/// Control loop on the joint angles that a hand measures, see JointLoop.
struct GAUNTLET_API JointLoopConfig {
  JointLoopKind kind = JointLoopKind::kNone;
  // Gains and limit: orcahand/orca_core PR #85, tuned on a hand of cables.
  double proportional = 0.5;
  double integral_per_s = 2.0;
  double max_correction_deg = 15.0;
  /// Delay of the hand's own: link, frames, servo and joint sensor. Here that of the default link
  /// and servos.
  double expected_delay_ms = 95.0;
  double dead_band_deg = 0.1;
  std::vector<double> friction_deg = {0.0};  // one for all joints, or one for each
  double friction_turn_deg = 1.0;
  double stale_after_ms = 50.0;  // orcahand/orca_core: beyond it the integral stands still

  void Visit(SettingsVisitor& visitor);
};

}  // namespace gauntlet::controller
