#pragma once

#include <string_view>

#include "controller/export.h"
#include "controller/settings.h"

namespace gauntlet::controller {

/// Exponential smoothing, a first-order low pass.
///
///     y(k) = y(k-1) + alpha (z(k) - y(k-1)),   y(0) = z(0)
///
/// Lowers white noise to sqrt(alpha / (2 - alpha)); delays slow motion by (1 - alpha) / alpha
/// samples. Source: Brown, Smoothing, Forecasting and Prediction (1963).
struct GAUNTLET_API ExponentialConfig {
  static constexpr std::string_view kKind = "exponential";
  static constexpr std::string_view kSummary = "exponential smoothing, a first-order low pass";

  double alpha = 0.1;

  void Visit(SettingsVisitor& visitor) {
    visitor.Number({"alpha", "weight of the new sample; 1 is no filter", 1e-9, 1}, alpha);
  }
};

}  // namespace gauntlet::controller
