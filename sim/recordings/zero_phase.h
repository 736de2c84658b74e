#pragma once

#include <span>

namespace gauntlet::sim {

/// Smooths a whole recording without delay: a second-order Butterworth low pass forward, then
/// backward. Its amplitude is 0.707 (-3 dB) at the cut-off; the ends are continued by reflection.
///
///     |H(f)|^2 of one pass = 1 / (1 + (tan(pi f / rate) / tan(pi f1 / rate))^4),
///     f1 chosen so that both passes together have 0.707 at the cut-off
///
/// Source: Butterworth 1930; Gustafsson 1996 for the two passes.
/// Units: Hz; the values keep theirs. The cut-off must lie below 0.4 of the rate.
void SmoothZeroPhase(double cutoff_hz, double rate_hz, std::span<double> values);

}  // namespace gauntlet::sim
