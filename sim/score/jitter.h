#pragma once

#include "sim/base/signal.h"
#include "sim/score/fourier.h"

namespace gauntlet::sim {

/// Everything above 10 Hz of some signals: what people see as trembling.
///
/// A zero-phase high pass: the signal minus its convolution with a symmetric low pass, a sinc in a
/// Kaiser window. Half the amplitude passes at 10 Hz; below 8 Hz at most 1e-4 of it, above 12 Hz
/// all but 1e-4 (80 dB). Steep on purpose: a Butterworth filter of order 4 run both ways still
/// takes 19 % off a trembling of 12 Hz. Ramps vanish exactly.
///
/// The kernel reaches 0.63 s to both sides. What lies outside the signal is unknown, so samples
/// nearer to an end than that have no value here: no padding, no edge effect.
struct Trembling {
  int first_sample = 0;  // row 0 belongs to this sample of the signal
  Signal angle_rad;      // samples x channels; no rows if the signal is too short
};

/// Source: Kaiser 1974; Oppenheim and Schafer, Discrete-Time Signal Processing, section 7.5.
/// Errors: none; a rate at or below 24 Hz cannot hold the band and gives no rows.
Trembling HighPass(const Signal& angle_rad, double rate_hz, Fourier& fourier);

}  // namespace gauntlet::sim
