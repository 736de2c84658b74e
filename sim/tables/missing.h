#pragma once

#include "controller/number.h"

namespace gauntlet::sim {

/// Placeholder in a table or a recording where there is no value.
inline constexpr double kMissing = controller::kNaN;

}  // namespace gauntlet::sim
