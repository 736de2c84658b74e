#pragma once

#include <memory>
#include <string_view>
#include <vector>

#include "controller/filters/filter.h"
#include "controller/settings.h"

namespace gauntlet::controller {

/// A FittedPredictionConfig whose weights are still to be fitted, to other recordings of motions
/// like these: what is predicted, and what the weights may look at. FitPredictor() makes the one of
/// the other.
struct FittedToOthersPredictionConfig {
  static constexpr std::string_view kKind = "fitted_to_others";
  static constexpr std::string_view kSummary =
      "as fitted, by weights that each repetition takes from all others of the scenario";

  std::vector<double> horizon_ms = {100.0};  // one for all channels or one for each
  int order = 40;
  double tap_ms = 5.0;
  /// The fit is made as if the noise had so many times its variance: a larger one trembles less and
  /// gives away some of the delay.
  double caution = 1.0;
  /// Also at where a channel is: it is then drawn to where hands of such motions go, also at rest.
  bool offset = false;
  /// Also at where all other channels are and how they move; needs `offset`.
  bool all_channels = false;

  void Visit(SettingsVisitor& visitor);
};

/// Errors: SettingError, always: without weights there is no predictor.
std::unique_ptr<Filter> MakePredictor(const FittedToOthersPredictionConfig& config,
                                      int channel_count, double rate_hz);

}  // namespace gauntlet::controller
