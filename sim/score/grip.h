#pragma once

#include <span>

#include "sim/score/fourier.h"

namespace gauntlet::sim {

/// Ripple of the force with which a hand holds an object [N].
///
///     RMS of the force above 10 Hz, over every stretch of grip
///
/// A stretch of grip is one without a sample below 0.1 N (an assumption: the weight of 10 g). It
/// goes through the high pass of jitter.h by itself, so the 0.63 s after the first touch and before
/// letting go do not count: what closing and opening do to the force is not ripple. NaN without a
/// stretch of 1.36 s.
double GripForceRipple(std::span<const double> force_n, double rate_hz, Fourier& fourier);

}  // namespace gauntlet::sim
