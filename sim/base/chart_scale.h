#pragma once

#include <limits>
#include <vector>

namespace gauntlet::sim {

/// Range of some values, from the lowest to the highest.
struct Extent {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();

  /// Extends the range to this value. Ignores a value that is not finite.
  void Include(double value);
  /// Extends the range by this share of its width at both ends; by 1 if the width is 0.
  void Widen(double share);
  /// Relative position of a value in the range, 0 to 1; 0.5 if the width is 0.
  double Share(double value) const { return high > low ? (value - low) / (high - low) : 0.5; }
};

/// A round step that gives about `count` ticks: 1, 2 or 5 times a power of ten.
double TickStep(const Extent& extent, int count);

/// All multiples of `step` in the range, both ends included.
std::vector<double> Ticks(const Extent& extent, double step);

}  // namespace gauntlet::sim
