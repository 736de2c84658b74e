#pragma once

#include <cmath>

namespace gauntlet::controller {

/// Below this a value is 0: counts or radians so small mean nothing, and what filters make of
/// numbers above (times a gain, a difference of two) stays far from 2.2e-308, where numbers become
/// subnormal and processors up to a hundred times slower.
inline constexpr double kLeastValue = 1e-150;

/// The value, or 0 in place of one that would sooner or later decay to a subnormal number. Enough
/// is one for each difference that a filter adds a share of: where that is 0, its memory stays as
/// it is.
inline double WithoutSubnormal(double value) { return std::abs(value) < kLeastValue ? 0.0 : value; }

/// A copy, value by value; `from` and `to` are apart or the same memory.
void CopyWithoutSubnormals(const double* from, double* to, int count) noexcept;

}  // namespace gauntlet::controller
