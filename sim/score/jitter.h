#pragma once

#include "sim/base/signal.h"
#include "sim/score/low_pass.h"

namespace gauntlet::sim {

/// Everything above 10 Hz of some angles: what people see as trembling.
///
/// A zero-phase high pass: the angle minus its low pass of 10 Hz, from 8 Hz (nothing passes) to
/// 12 Hz (all passes). Steep on purpose: a Butterworth filter of order 4 run both ways still takes
/// 19 % off a trembling of 12 Hz. Ramps vanish exactly. It reaches 0.63 s to both sides; samples
/// nearer to an end than that have no value.
///
/// No rows for a signal too short, or a rate at or below 24 Hz, which cannot hold the band.
FilteredSignal Trembling(const Signal& angle_rad, double rate_hz, Fourier& fourier);

}  // namespace gauntlet::sim
