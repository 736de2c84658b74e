#pragma once

#include "controller/export.h"
#include "controller/settings.h"

namespace gauntlet::controller {

enum class Rounding { kNearest, kHysteresis, kNoiseShaping };

/// How commands become whole motor counts, see MotorRounding.
struct GAUNTLET_API MotorRoundingConfig {
  Rounding rounding = Rounding::kNearest;
  double hysteresis_counts = 0.5;
  /// About three times as fast as a common servo turns without load (an assumption): never in the
  /// way of a motion, and a bound on what a recovering sensor can do.
  double speed_limit_rad_s = 20.0;

  void Visit(SettingsVisitor& visitor);
};

}  // namespace gauntlet::controller
