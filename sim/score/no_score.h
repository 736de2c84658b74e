#pragma once

#include <limits>

namespace gauntlet::sim {

/// What stands where a score does not exist.
inline constexpr double kNoScore = std::numeric_limits<double>::quiet_NaN();

}  // namespace gauntlet::sim
