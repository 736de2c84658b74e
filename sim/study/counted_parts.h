#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "sim/study/study.h"

namespace gauntlet::sim {

/// Which ticks of a trial of `ticks` count, of every measured part; nothing where all do. A joint
/// follows the channels that move it, a motor and its cables those of all joints that it turns, the
/// hand as a whole all of them.
std::optional<CountedParts> CountedPartsOf(const Study& study,
                                           std::span<const MaskedStretch> masked, int ticks);

/// Per measured joint the share of the time that counts, over all repetitions.
std::vector<double> CountedShares(const Study& study);

/// What is left out of the scores and why, in one line; empty where all counts.
std::string CountedRemark(const Study& study);

}  // namespace gauntlet::sim
