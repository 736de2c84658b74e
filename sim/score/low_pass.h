#pragma once

#include <vector>

#include "sim/base/signal.h"
#include "sim/score/fourier.h"

namespace gauntlet::sim {

/// A symmetric low pass of finite length: a sinc in a Kaiser window. It has no phase at all.
///
///     w_n = sin(omega_c n) / n * I0(beta sqrt(1 - (n/reach)^2)),   scaled to a sum of 1
///
/// Half the amplitude passes at the cutoff. Below cutoff - transition/2 and above
/// cutoff + transition/2 the response is 1 and 0 to about 1e-4 (80 dB).
/// Source: Kaiser 1974; Oppenheim and Schafer, Discrete-Time Signal Processing, section 7.5.
struct LowPass {
  std::vector<double> weights;  // at offsets 0 .. reach, the same to both sides

  int reach() const { return static_cast<int>(weights.size()) - 1; }
};

LowPass DesignLowPass(double cutoff_hz, double transition_hz, double rate_hz);

/// The reach of that filter, which its weights are not needed for.
int LowPassReach(double transition_hz, double rate_hz);

/// Part of some signals behind a filter. What lies outside a signal is unknown, so samples nearer
/// to an end than the filter's reach have no value here: no padding, no edge effect.
struct FilteredSignal {
  int first_sample = 0;  // row 0 belongs to this sample of the signal
  Signal values;         // samples x channels; no rows if the signal is too short
};

/// Part of a signal that passes the low pass, or that it takes away.
enum class Band { kBelow, kAbove };
/// By transforms of blocks that overlap by the filter's length (overlap-save: Oppenheim and
/// Schafer, section 8.7.3), so that a block stays in the processor's cache however long the signal
/// is.
FilteredSignal Filter(const LowPass& low_pass, Band band, const Signal& signal, Fourier& fourier);

}  // namespace gauntlet::sim
