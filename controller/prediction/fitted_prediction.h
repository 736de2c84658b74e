#pragma once

#include <string_view>
#include <vector>

#include "controller/export.h"
#include "controller/settings.h"

namespace gauntlet::controller {

/// A weighted sum of the past, with weights that were fitted to motions like these: of each
/// channel's own, and of where all channels are and how they move:
///
///     y_c(k) = z_c(k) + sum over i = 1 .. order of w_ci (m_ci(k) - z_c(k))
///                     + sum over channels d of p_cd m_d1(k) + s_cd (m_d1(k) - m_dn(k))  + o_c
///
/// m_ci(k) is the sample z_c(k - i tap) or, with `tap_means`, the mean of the samples from there
/// to the next tap; n = min(order, 6). Without p and o a hand at rest is predicted to stay,
/// whatever the weights; with them it is drawn to where hands of such motions go.
///
/// A channel that is held, as the guard holds a broken one, counts for the others as one that has
/// come to rest there.
///
/// Shapes: `weights` (w) has `order` values for all channels, or `order` for each, channel by
/// channel; `position_weights` (p) none, one per channel for its own, or for each channel one of
/// every channel; `slope_weights` (s) none, or for each channel one of every channel; `offset_deg`
/// (o) none or one per channel. `horizon_ms` is how far ahead they were fitted for.
///
/// With `fallback` the output is a mixture with the prediction `adaptive` of the same horizon and
/// of `r_deg2`, by how far each has missed of late: see WithFallback(). Without a horizon there is
/// none. Errors: SettingError for other numbers of values, or taps that are no step apart.
struct GAUNTLET_API FittedPredictionConfig {
  static constexpr std::string_view kKind = "fitted";
  static constexpr std::string_view kSummary =
      "by weights that gauntlet calibrate --predictor has fitted";

  static constexpr int kSlopeTaps = 6;

  std::vector<double> horizon_ms = {0.0};
  int order = 1;
  double tap_ms = 5.0;
  bool tap_means = false;
  std::vector<double> weights = {0.0};
  std::vector<double> position_weights = {};
  std::vector<double> slope_weights = {};
  std::vector<double> offset_deg = {};
  bool fallback = true;
  std::vector<double> r_deg2 = {0.5};

  void Visit(SettingsVisitor& visitor);
};

}  // namespace gauntlet::controller
