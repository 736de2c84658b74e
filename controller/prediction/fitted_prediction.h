#pragma once

#include <memory>
#include <string_view>
#include <vector>

#include "controller/filters/filter.h"
#include "controller/settings.h"

namespace gauntlet::controller {

/// A weighted sum of samples `tap_ms` apart, with weights that were fitted to motions like these,
/// and of what the channels do together, their components:
///
///     y(k) = z(k) + sum over i = 1 .. order of w_i (z(k - i tap) - z(k))
///                 + sum over m = 1 .. components, i of v_mi (s_m(k - i tap) - s_m(k))
///     s_m(k) = sum over channels c of l_mc z_c(k)
///
/// A hand at rest is predicted to stay, whatever the weights. How far ahead y is decided by what
/// they were fitted for: `gauntlet calibrate --predictor` writes them.
///
/// A channel that is held, as the guard holds a broken one, adds nothing to the others from
/// `order` taps later on: they are predicted as if it had come to rest.
///
/// Shapes: `weights` has `order` values for all channels, or `order` for each, channel by channel;
/// `loadings` (l) one per channel, component by component; `component_weights` (v) `order` per
/// component, component by component, for all channels or for each, channel by channel.
/// Errors: SettingError for other numbers of values, or taps that are no step apart.
struct FittedPredictionConfig {
  static constexpr std::string_view kKind = "fitted";
  static constexpr std::string_view kSummary =
      "by weights that gauntlet calibrate --predictor has fitted";

  int order = 1;
  double tap_ms = 5.0;
  std::vector<double> weights = {0.0};
  int components = 0;
  std::vector<double> loadings = {};
  std::vector<double> component_weights = {};

  void Visit(SettingsVisitor& visitor);
};

/// Errors: SettingError.
std::unique_ptr<Filter> MakePredictor(const FittedPredictionConfig& config, int channel_count,
                                      double rate_hz);

}  // namespace gauntlet::controller
