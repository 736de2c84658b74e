#pragma once

#include <vector>

#include "sim/hand/drive.h"
#include "sim/hand/engine_types.h"

namespace gauntlet::sim {

/// Makes connects, welds and dry friction hold where the model leaves their solref or solimp to the
/// engine. Its defaults, a spring of 20 ms, let linkages open and joints creep. Joints of motors
/// have friction of their own and stay as they are.
void FirmConstraints(mjModel_& model, const std::vector<Drive>& drives);

}  // namespace gauntlet::sim
