#pragma once

#include "sim/base/signal.h"
#include "sim/score/counted_ticks.h"
#include "sim/score/low_pass.h"

namespace gauntlet::sim {

/// Everything above an edge, by default 10 Hz, of some angles: jitter.
///
/// A zero-phase high pass: the angle minus its low pass at the edge, from 0.8 (nothing passes) to
/// 1.2 times the edge (all passes). Steep on purpose: a Butterworth filter of order 4 run both ways
/// still takes 19 % off jitter of 1.2 times the edge. Ramps vanish exactly. It reaches 6.3
/// periods of the edge to both sides (0.63 s for 10 Hz); samples nearer to an end have no value.
///
/// No rows for a signal that is shorter than that and one period of the edge, or a rate at or below
/// 2.4 times the edge, which cannot hold the band.
FilteredSignal Trembling(const Signal& angle_rad, double rate_hz, double above_hz,
                         Fourier& fourier);

/// RMS of an acceleration above an edge, from a velocity: its difference from tick to tick, behind
/// the same high pass. The square is the sum over its directions. Shape: ticks x directions.
/// kNoScore where no tick counts, or the signal is too short.
double AccelerationAbove(const Signal& velocity, double rate_hz, double above_hz,
                         const CountedTicks& counted, Fourier& fourier);

/// The ticks in whose jitter only ticks that count have a share: of each range all but the reach
/// of the high pass at both ends; none of one that is too short.
CountedTicks TremblingWithin(const CountedTicks& counted, double rate_hz, double above_hz);

/// The shortest signal that can contain jitter, in ticks.
Eigen::Index TremblingTicks(double rate_hz, double above_hz);

}  // namespace gauntlet::sim
