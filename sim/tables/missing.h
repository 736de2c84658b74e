#pragma once

#include <algorithm>
#include <cmath>
#include <span>

#include "controller/number.h"

namespace gauntlet::sim {

/// Placeholder in a table or a recording where there is no value.
inline constexpr double kMissing = controller::kNaN;

/// True for equal values in equal places; two missing ones are equal.
inline bool AreSame(std::span<const double> some, std::span<const double> others) {
  return std::ranges::equal(some, others, [](double one, double other) {
    return one == other || (std::isnan(one) && std::isnan(other));
  });
}

}  // namespace gauntlet::sim
