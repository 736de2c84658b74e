#pragma once

#include <string>
#include <vector>

#include "sim/glove/motions/recording_mask.h"
#include "sim/recordings/recording.h"

namespace gauntlet::sim {

/// By how much later the same moment is in `reference` than in `recording` [s]: the lag of the
/// largest correlation of all channels that both have, within 10 s to both sides, of the first
/// minute of the stretch.
///
///     argmax over d of  sum (x_c(t) - mean) (y_c(t + d) - mean) / sqrt(sum (..)^2 sum (..)^2)
///
/// at 100 Hz, refined by a parabola. Errors: UserError about `reference` where no correlation is
/// above 0.5, or the largest lies at the bound.
double FindReferenceOffset(const Recording& recording, const Recording& reference,
                           const PlayedStretch& stretch);

/// Refuses a reference that does not cover the stretch, but for a gap at its ends that would be
/// filled anywhere else. `stretch` is in the reference's own time. Errors: UserError.
void CheckReferenceCovers(const Recording& reference, const PlayedStretch& stretch, double gap_s);

}  // namespace gauntlet::sim
