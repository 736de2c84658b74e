#pragma once

#include <vector>

#include "controller/export.h"
#include "controller/settings.h"

namespace gauntlet::controller {

enum class ModelPredictiveKind { kNone, kSecondOrder };

/// Model of the way from a command to the angle of a joint, and settings of the plan of commands
/// for it, see ModelPredictive.
struct GAUNTLET_API ModelPredictiveConfig {
  ModelPredictiveKind kind = ModelPredictiveKind::kNone;
  int steps = 6;
  // One for all joints, or one for each. The means of what `gauntlet identify --from target` finds
  // of the default hand.
  std::vector<double> dead_time_ms = {24.0};
  std::vector<double> lag_ms = {62.0};
  std::vector<double> natural_frequency_hz = {5.0};
  double change_weight = 1.0;
  double speed_limit_deg_s = 0.0;
  double lead_limit_deg = 0.0;
  int iterations = 50;

  void Visit(SettingsVisitor& visitor);
};

}  // namespace gauntlet::controller
