#pragma once

#include <span>

#include "sim/base/signal.h"

namespace gauntlet::sim {

/// The step to which values were rounded: 1 for counts, the volts of one count for volts; 0 for
/// values that were not rounded.
///
/// Of each channel, the smallest distance between values that occur, if it has eight values or
/// more, half of the neighbours among them lie one step apart, and the others up to five steps do
/// so in whole steps (to a quarter of one, as the text of volts is rounded once more). Of the
/// channels that tell, the smallest; if none does, 1 for whole numbers.
/// Shapes: samples x channels, finite.
double ResolutionOf(const Signal& values);

}  // namespace gauntlet::sim
