#pragma once

#include <span>

#include "sim/base/random.h"

namespace gauntlet::sim {

/// Adds noise whose power falls as 1 / frequency between 0.1 Hz and a quarter of the rate.
///
/// White noise through poles and zeros that alternate evenly on the axis of log frequency, two of
/// each per decade: the amplitude falls by 10 dB a decade within 0.5 dB. Scaled to the variance it
/// has in the long run, and started in that state.
/// Source: Corsini and Saletti 1988, the idea of the alternating poles and zeros.
void AddPinkNoise(RandomStream& random, double standard_deviation, double rate_hz,
                  std::span<double> signal);

/// Adds a sine of mains frequency with a random phase.
void AddMainsHum(RandomStream& random, double amplitude, double mains_hz, double rate_hz,
                 std::span<double> signal);

}  // namespace gauntlet::sim
