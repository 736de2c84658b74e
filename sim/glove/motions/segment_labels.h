#pragma once

#include <vector>

#include "sim/base/signal.h"
#include "sim/glove/motions/motion.h"

namespace gauntlet::sim {

/// Cuts a motion into stretches by what the hand as a whole does; every sample is in one of them.
///
///     speed = root mean square over the channels that move at all of their angular speeds
///     rest      speed below 2 deg/s for at least 100 ms
///     onset     the first 200 ms after a rest
///     reversal  100 ms before and after the channel with the largest range turns round
///     slow      the remaining speed below 40 deg/s
///     fast      the rest of it
///
/// Source: the limits are assumptions; 40 deg/s is about the mean speed of a relaxed grasp.
std::vector<MotionSegment> LabelBySpeed(const Signal& angle_rad, double rate_hz);

}  // namespace gauntlet::sim
