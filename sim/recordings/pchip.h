#pragma once

#include <span>

namespace gauntlet::sim {

/// Values at start_s + i / rate_hz of the shape-preserving cubic through (time, value): no
/// overshoot between the points, constant beyond the first and last point.
///
///     slope_k = 0                                     where the data turns
///     slope_k = 3 (h0 + h1) / ((2 h1 + h0) / d0 + (h1 + 2 h0) / d1)   elsewhere
///
/// with the steps h and the slopes d of the two neighbouring stretches; one-sided at the ends.
/// Source: Fritsch and Carlson 1980; Fritsch and Butland 1984. Cost: one pass over both.
/// Shapes: as many times as values, at least one; `time_s` rises strictly.
void InterpolatePchip(std::span<const double> time_s, std::span<const double> value, double start_s,
                      double rate_hz, std::span<double> result);

}  // namespace gauntlet::sim
