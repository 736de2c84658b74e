#pragma once

#include <limits>

namespace gauntlet::sim {

/// What stands in a table or a recording where there is no value.
inline constexpr double kMissing = std::numeric_limits<double>::quiet_NaN();

}  // namespace gauntlet::sim
