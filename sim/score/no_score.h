#pragma once

#include "controller/number.h"

namespace gauntlet::sim {

/// What stands where a score does not exist.
inline constexpr double kNoScore = controller::kNaN;

}  // namespace gauntlet::sim
