#pragma once

#include <memory>
#include <string_view>
#include <vector>

#include "controller/filters/filter.h"
#include "controller/settings.h"

namespace gauntlet::controller {

/// A weighted sum of samples `tap_ms` apart, with weights that were fitted to motions like these:
///
///     y(k) = z(k) + sum over i = 1 .. order of w_i (z(k - i tap) - z(k))
///
/// A hand at rest is predicted to stay, whatever the weights. How far ahead y is decided by what
/// they were fitted for: `gauntlet calibrate --predictor` writes them.
///
/// Shapes: `weights` has `order` values for all channels, or `order` for each, channel by channel.
/// Errors: SettingError for another number of weights, or taps that are no step apart.
struct FittedPredictionConfig {
  static constexpr std::string_view kKind = "fitted";
  static constexpr std::string_view kSummary =
      "by weights that gauntlet calibrate --predictor has fitted";

  int order = 1;
  double tap_ms = 5.0;
  std::vector<double> weights = {0.0};

  void Visit(SettingsVisitor& visitor);
};

/// Errors: SettingError.
std::unique_ptr<Filter> MakePredictor(const FittedPredictionConfig& config, int channel_count,
                                      double rate_hz);

}  // namespace gauntlet::controller
