#pragma once

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

#include "controller/assert.h"

namespace gauntlet::controller {

/// Statistics that a few wrong values do not move.

/// The value in the middle, of an even number the upper of the two. `values` is not empty.
template <class Value = double>
Value MedianOf(std::vector<Value> values) {
  GAUNTLET_ASSERT(!values.empty());
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Standard deviation of normal noise, from its distances to where it is centred: it is as often
/// within 0.6745 standard deviations as not.
inline double DeviationFromDistances(std::vector<double> distances) {
  return MedianOf(std::move(distances)) / 0.6745;
}

}  // namespace gauntlet::controller
