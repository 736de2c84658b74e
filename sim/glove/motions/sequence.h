#pragma once

#include "sim/glove/motions/motion.h"

namespace gauntlet::sim {

/// Puts `next` behind `motion`, joined so that angle, velocity and acceleration are continuous.
///
/// Over the first `blend_s` of `next` a fifth-order polynomial is added that takes up the
/// differences at the joint and is zero with its derivatives at its end.
void AppendMotion(const Motion& next, double blend_s, double rate_hz, Motion& motion);

}  // namespace gauntlet::sim
