#pragma once

#include "controller/number.h"

namespace gauntlet::sim {

/// Placeholder of a score that does not exist.
inline constexpr double kNoScore = controller::kNaN;

}  // namespace gauntlet::sim
