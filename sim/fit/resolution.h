#pragma once

#include <span>

#include "sim/base/signal.h"

namespace gauntlet::sim {

/// Quantisation step of the values: 1 for counts, the volts of one count for volts, 0 without
/// quantisation.
///
/// The step of a channel is the smallest distance between two different values. Conditions: eight
/// different values or more; half of the neighbouring values are one step apart; distances up to
/// five steps are multiples of it, with a tolerance of a quarter step, because the text of volts is
/// rounded again. The result is the smallest step of the channels that meet them. If none does, it
/// is 1 for whole numbers.
/// Shapes: samples x channels, finite.
double ResolutionOf(const Signal& values);

}  // namespace gauntlet::sim
