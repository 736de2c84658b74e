#pragma once

#include <string_view>

#include "controller/export.h"
#include "controller/settings.h"

namespace gauntlet::controller {

/// The mean of the last samples: the paper's first attempt ("the simple mean filter").
///
///     y(k) = (z(k) + z(k-1) + ... + z(k-m+1)) / m,   m = min(window, samples seen)
///
/// Delays by (window - 1) / 2 samples and lowers white noise to 1 / sqrt(window).
/// Source: Bai, Jiang, Yokoi, section 2.1.
struct GAUNTLET_API MovingAverageConfig {
  static constexpr std::string_view kKind = "moving_average";
  static constexpr std::string_view kSummary = "mean of the last samples";

  int window = 20;  // one command frame of 20 ms at 1 kHz

  void Visit(SettingsVisitor& visitor) {
    visitor.Integer({"window", "samples averaged", 1, 100000}, window);
  }
};

}  // namespace gauntlet::controller
