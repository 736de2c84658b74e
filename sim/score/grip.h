#pragma once

#include <span>

#include "sim/score/counted_ticks.h"
#include "sim/score/fourier.h"

namespace gauntlet::sim {

/// Grip force [N] from which on the hand touches the object: the weight of 10 g (an assumption).
inline constexpr double kTouchN = 0.1;

/// Ripple of the force with which a hand holds an object [N].
///
///     RMS of the force above an edge as of jitter.h, over every stretch of grip
///
/// A stretch of grip is one of samples that count without one below kTouchN. It goes through the
/// high pass by itself, so that what is within its reach of the first touch or of letting go (0.63
/// s for 10 Hz) does not count: what closing and opening do to the force is not ripple. NaN without
/// a stretch that is long enough (1.36 s for 10 Hz).
double GripForceRipple(std::span<const double> force_n, double rate_hz, double above_hz,
                       const CountedTicks& counted, Fourier& fourier);

}  // namespace gauntlet::sim
