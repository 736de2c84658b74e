#pragma once

#include <limits>
#include <vector>

namespace gauntlet::sim {

/// From the lowest to the highest of some values.
struct Extent {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();

  /// What is not finite does not count.
  void Take(double value);
  /// By this share of the extent to both sides; by 1 where there is none.
  void Widen(double share);
  /// Where a value lies, 0 to 1; in the middle where there is no extent.
  double Share(double value) const { return high > low ? (value - low) / (high - low) : 0.5; }
};

/// A round step that gives about `count` ticks: 1, 2 or 5 times a power of ten.
double TickStep(const Extent& extent, int count);

/// The multiples of `step` in the extent, its ends included.
std::vector<double> Ticks(const Extent& extent, double step);

}  // namespace gauntlet::sim
