#pragma once

#include <algorithm>
#include <cmath>

#include "controller/settings.h"

namespace gauntlet::sim {

/// The analog-digital converter: rounds to whole counts and clips at both ends of its scale.
///
/// Source: 10 bits is an assumption; the paper's variances R fit a converter of this size.
struct ConverterConfig {
  int bits = 10;

  double full_scale_counts() const { return std::ldexp(1.0, bits) - 1.0; }

  void Visit(controller::SettingsVisitor& visitor) {
    visitor.Integer({"bits", "resolution; the scale is 0 to 2^bits - 1 counts", 8, 24}, bits);
  }
};

/// Whole counts for an analog value [counts].
inline double Convert(double analog_counts, double full_scale_counts) {
  return std::clamp(std::nearbyint(analog_counts), 0.0, full_scale_counts);
}

}  // namespace gauntlet::sim
