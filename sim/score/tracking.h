#pragma once

#include <span>
#include <vector>

#include "sim/score/counted_ticks.h"

namespace gauntlet::sim {

/// sqrt(mean(values^2)); NaN of nothing. Units: those of the input.
double Rms(std::span<const double> values);

/// values - others, one by one; as long as the shorter of them.
std::vector<double> Differences(std::span<const double> values, std::span<const double> others);

/// RMS of the values within ranges; value 0 belongs to tick `first_tick`.
double RmsWithin(std::span<const double> values, int first_tick,
                 const std::vector<TickRange>& ranges);

/// max |values| within ranges; NaN of nothing.
double PeakWithin(std::span<const double> values, const std::vector<TickRange>& ranges);

/// How often the increments of a command change their sign, per second. Samples at which the
/// command stands still are passed over, so the count does not depend on how long a frame is held.
/// Within ranges, each by itself.
double ReversalsPerSecond(std::span<const int> command, double rate_hz,
                          const std::vector<TickRange>& ranges);

}  // namespace gauntlet::sim
