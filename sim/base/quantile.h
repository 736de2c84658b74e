#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "controller/assert.h"
#include "controller/number.h"

namespace gauntlet::sim {

/// Quantile of the values at `share`, 0 to 1: one of the values, the lower one between two. NaN
/// without values.
inline double Quantile(std::vector<double> values, double share) {
  GAUNTLET_ASSERT(0.0 <= share && share <= 1.0);
  if (values.empty()) return controller::kNaN;
  const auto last = static_cast<double>(std::ssize(values) - 1);
  const auto place = values.begin() + static_cast<std::ptrdiff_t>(share * last);
  std::ranges::nth_element(values, place);
  return *place;
}

}  // namespace gauntlet::sim
