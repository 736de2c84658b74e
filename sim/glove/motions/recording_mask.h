#pragma once

#include <vector>

#include "sim/base/masked_stretch.h"
#include "sim/recordings/recording.h"

namespace gauntlet::sim {

/// The stretch of a recording that a motion plays: tick i is at start_s + i / rate_hz.
struct PlayedStretch {
  double start_s = 0.0;
  double rate_hz = 1000.0;  // of ticks
  std::size_t ticks = 0;

  /// The first tick at or after this time of the recording, within the stretch.
  int TickAt(double time_s) const;
};

/// Adds what one channel of a recording does not know: its gaps, as Resample() found them, and the
/// restarts of its clock.
void AddGapsAndRestarts(const Recording& recording, int channel, const PlayedStretch& stretch,
                        const std::vector<bool>& in_gap, std::vector<MaskedStretch>& masked);
/// Likewise, where a sensor was clipped.
void AddClipped(const Recording& recording, int channel, const PlayedStretch& stretch,
                std::vector<MaskedStretch>& masked);

/// Smooths one channel without delay, between gaps and restarts each piece by itself, so that
/// nothing leaks from one moment into another.
void SmoothBetween(const std::vector<MaskedStretch>& masked, int channel, double cutoff_hz,
                   double rate_hz, std::span<double> angle_rad);

}  // namespace gauntlet::sim
