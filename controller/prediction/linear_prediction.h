#pragma once

#include <string_view>
#include <vector>

#include "controller/export.h"
#include "controller/settings.h"

namespace gauntlet::controller {

/// The newest value plus horizon times the slope of the last `window_ms` (least squares).
///
///     y(k) = z(k) + horizon slope(k)
///
/// Source: Bai, Jiang, Yokoi, section 5.
struct GAUNTLET_API LinearPredictionConfig {
  static constexpr std::string_view kKind = "linear";
  static constexpr std::string_view kSummary = "along the slope of the last samples";

  std::vector<double> horizon_ms = {45.0};  // the paper's bound of the event time
  double window_ms = 60.0;

  void Visit(SettingsVisitor& visitor);
};

}  // namespace gauntlet::controller
