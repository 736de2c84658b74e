#pragma once

#include <span>
#include <vector>

namespace gauntlet::sim {

/// Slopes of the shape-preserving cubic through (time, value): no overshoot between the points.
///
///     slope_k = 0                                     where the data turns
///     slope_k = 3 (h0 + h1) / ((2 h1 + h0) / d0 + (h1 + 2 h0) / d1)   elsewhere
///
/// with the steps h and the slopes d of the two neighbouring stretches; one-sided at the ends.
/// Source: Fritsch and Carlson 1980; Fritsch and Butland 1984.
/// Shapes: as many slopes as points, at least one; `time_s` rises strictly.
std::vector<double> PchipSlopes(std::span<const double> time_s, std::span<const double> value);

/// Values of that curve at start_s + i / rate_hz, constant beyond the first and last point.
/// Cost: one pass over both.
void InterpolatePchip(std::span<const double> time_s, std::span<const double> value, double start_s,
                      double rate_hz, std::span<double> result);

}  // namespace gauntlet::sim
