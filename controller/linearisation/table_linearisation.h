#pragma once

#include <memory>
#include <vector>

#include "controller/linearisation/linearisation.h"

namespace gauntlet::controller {

/// Broken lines, one per channel. Errors: fewer than two corners, counts that do not grow, or
/// angles that do not all grow or all fall.
std::unique_ptr<Linearisation> MakeTableLinearisation(const std::vector<ChannelCurve>& curves);

}  // namespace gauntlet::controller
