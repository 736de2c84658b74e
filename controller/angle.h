#pragma once

#include <numbers>

namespace gauntlet::controller {

/// Settings are in degrees, everything else in radians.
inline constexpr double kRadPerDeg = std::numbers::pi / 180.0;
inline constexpr double kDegPerRad = 180.0 / std::numbers::pi;

}  // namespace gauntlet::controller
