#pragma once

#include <cstdint>

#include "sim/base/signal.h"
#include "sim/glove/motions/motion_config.h"

namespace gauntlet::sim {

/// Band-limited random motion: a uniform cubic B-spline whose control values are independent and
/// uniform within the range.
///
///     angle(t) = sum_k c_k B3(t / T - k),   spectrum of B3: sinc(f T)^4,  T = 0.2282 / bandwidth
///
/// The curve stays inside the range of its control values (convex hull), has continuous
/// acceleration, and less than 0.1 % of its power above three times the bandwidth. Its amplitude is
/// down to 0.707 at the bandwidth: sinc(0.2282)^4 = 0.707.
/// Units: rad, Hz. Each channel has a random stream of its own.
Signal RandomMotion(const RandomMotionConfig& config, int samples, double rate_hz,
                    std::uint64_t seed);

}  // namespace gauntlet::sim
