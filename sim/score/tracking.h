#pragma once

#include <span>

namespace gauntlet::sim {

/// sqrt(mean((hand - reference)^2)). Shapes: the same length. Units: those of the input.
double RmsDifference(std::span<const double> reference, std::span<const double> hand);

/// max |hand - reference|.
double PeakDifference(std::span<const double> reference, std::span<const double> hand);

/// sqrt(mean(values^2)); NaN of nothing.
double Rms(std::span<const double> values);

/// How often the increments of a command change their sign, per second. Samples at which the
/// command stands still are passed over, so the count does not depend on how long a frame is held.
double ReversalsPerSecond(std::span<const int> command, double rate_hz);

}  // namespace gauntlet::sim
