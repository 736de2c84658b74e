#pragma once

#include "controller/controller_config.h"
#include "controller/export.h"

namespace gauntlet::controller {

/// True if both have the same glove, hand, timing and joint map: a controller of one can be
/// prepared with the settings of the other.
GAUNTLET_API bool SameConnections(const RobotConfig& a, const RobotConfig& b);

}  // namespace gauntlet::controller
