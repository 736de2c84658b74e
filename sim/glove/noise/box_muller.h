#pragma once

#include <span>

#include "sim/base/normal_pair.h"

namespace gauntlet::sim {

/// Adds white Gaussian noise to a signal, by the basic form of the Box-Muller transform.
///
/// Source: Bai, Jiang, Yokoi, section 2.3.3.1. Units: those of the signal.
void AddBoxMuller(RandomStream& random, double standard_deviation, std::span<double> signal);

}  // namespace gauntlet::sim
