#pragma once

#include <string_view>
#include <vector>

#include "controller/export.h"
#include "controller/settings.h"

namespace gauntlet::controller {

/// Describes weights that are not fitted yet: how far to look ahead, and what the weights may use.
/// FitPredictor() makes a FittedPredictionConfig of it, from recordings of similar motions.
struct GAUNTLET_API FittedToOthersPredictionConfig {
  static constexpr std::string_view kKind = "fitted_to_others";
  static constexpr std::string_view kSummary =
      "as fitted, with weights fitted to all other replicates of the scenario";

  std::vector<double> horizon_ms = {100.0};  // one for all channels or one for each
  int order = 40;
  double tap_ms = 5.0;
  /// The fit is made as if the noise had so many times its variance. A larger value gives less
  /// jitter and more delay.
  double caution = 1.0;
  /// The weights also use the position of the channel. Then a hand at rest is predicted to move
  /// towards where such motions usually are.
  bool offset = false;
  /// The weights also use position and speed of all other channels; needs `offset`.
  bool all_channels = false;
  /// As in FittedPredictionConfig.
  bool fallback = true;
  std::vector<double> r_deg2 = {0.5};

  void Visit(SettingsVisitor& visitor);
};

}  // namespace gauntlet::controller
