#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "controller/export.h"

namespace gauntlet::controller {

/// A stretch of samples [begin, end) in which the wearer held still.
struct GAUNTLET_API StillStretch {
  std::ptrdiff_t begin = 0;
  std::ptrdiff_t end = 0;
};

/// Stretches of at least `min_duration_s` in which no channel moves: levels of 50 ms stay where
/// the stretch began and where the last one was, within what the noise of each channel allows. The
/// 50 ms beside a motion are left out. A level is the mean without spikes.
///
/// The noise is judged from differences of samples at most 32 ms apart, which motion hardly
/// touches, in the quietest quarter of the recording. Noise that is correlated over longer than
/// that looks like slow motion.
/// Shapes: `counts` has all samples of the first channel, then those of the next, as many for each;
/// finite. Errors: SettingError for another number of values; no stretch is an empty list.
GAUNTLET_API std::vector<StillStretch> FindStillStretches(std::span<const double> counts,
                                                          int channel_count, double rate_hz,
                                                          double min_duration_s = 0.5);

}  // namespace gauntlet::controller
