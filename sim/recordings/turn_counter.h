#pragma once

#include <cmath>

namespace gauntlet::sim {

/// The next value of a column whose values jump by `wraps_at` (0: they do not), without the jumps.
/// `before` is the value before (NaN at first), `turned` what was added since (0 at first). NaN
/// stays NaN and changes nothing.
inline double Unwrapped(double value, double wraps_at, double& before, double& turned) {
  if (wraps_at == 0.0 || std::isnan(value)) return value;
  const double step = value - before;
  if (step > 0.5 * wraps_at) turned -= wraps_at;
  if (step < -0.5 * wraps_at) turned += wraps_at;
  before = value;
  return value + turned;
}

}  // namespace gauntlet::sim
