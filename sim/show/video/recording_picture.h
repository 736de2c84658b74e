#pragma once

#include "sim/recordings/inspect/inspection.h"
#include "sim/show/video/image.h"

namespace gauntlet::sim {

/// A third-party recording at a glance: a row per sensor with the joint that it is taken for, its
/// curve, its range and what is wrong with it. Errors: UserError if there is no sensor in it.
Image DrawRecording(const Inspection& inspection);

}  // namespace gauntlet::sim
