#pragma once

#include <string_view>
#include <vector>

#include "controller/export.h"
#include "controller/settings.h"

namespace gauntlet::controller {

/// Learns while running how what comes follows from what was, by recursive least squares with
/// forgetting, each channel by itself:
///
///     s = z smoothed over `smoothing_ms`,   p_i(k) = s(k) - s(k - i tap),  i = 1 .. order
///     y(k) = s(k) + w p(k), within `leash_deg` of s(k)
///     w and P from  z(k) - s(k - h)  and  p(k - h):
///     g = P p / (f + p' P p),  w += g (z - s - w p),  P = (P - g p' P) / f
///     f = exp(-step / memory), or 1 where P would become larger than it began
///
/// It begins with w = 0, which does not look ahead. A hand at rest, from which nothing can be
/// learned, makes neither weights nor P grow without bound. A p of more than half a turn, which no
/// joint makes, teaches nothing.
///
/// Source: Ljung, System Identification, 11.2. Errors: SettingError if `horizon_ms` has neither one
/// value nor one per channel, or taps are no step apart.
struct GAUNTLET_API AutoregressivePredictionConfig {
  static constexpr std::string_view kKind = "autoregressive";
  static constexpr std::string_view kSummary = "by weights that it learns while running";

  std::vector<double> horizon_ms = {45.0};  // the paper's bound of the event time
  int order = 5;
  double tap_ms = 20.0;
  double smoothing_ms = 10.0;
  double memory_ms = 2000.0;
  double leash_deg = 30.0;

  void Visit(SettingsVisitor& visitor);
};

}  // namespace gauntlet::controller
