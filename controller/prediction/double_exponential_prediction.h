#pragma once

#include <string_view>
#include <vector>

#include "controller/export.h"
#include "controller/settings.h"

namespace gauntlet::controller {

/// Smoothed once, s, and once more, d, which together give a trend to look along:
///
///     s += a (z - s),  d += a (s - d),  a = 1 - exp(-step / smoothing)
///     y = (2 + a h / (1 - a)) s - (1 + a h / (1 - a)) d          h in steps
///
/// Source: LaViola, "Double exponential smoothing: an alternative to Kalman filter-based predictive
/// tracking", EGVE 2003, equations 2 to 4. Errors: SettingError if `horizon_ms` has neither one
/// value nor one per channel.
struct GAUNTLET_API DoubleExponentialPredictionConfig {
  static constexpr std::string_view kKind = "double_exponential";
  static constexpr std::string_view kSummary = "along the trend of smoothing twice";

  std::vector<double> horizon_ms = {45.0};  // the paper's bound of the event time
  double smoothing_ms = 30.0;

  void Visit(SettingsVisitor& visitor);
};

}  // namespace gauntlet::controller
