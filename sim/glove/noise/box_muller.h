#pragma once

#include <cmath>
#include <span>

#include "sim/base/random.h"

namespace gauntlet::sim {

/// Adds white Gaussian noise to a signal, by the basic form of the Box-Muller transform.
///
///     Z0 = sqrt(-2 ln U1) cos(2 pi U2)        U1 in (0, 1], U2 in [0, 1) independent
///     Z1 = sqrt(-2 ln U1) sin(2 pi U2)
///
/// Source: Bai, Jiang, Yokoi, section 2.3.3.1; Box and Muller 1958.
/// Units: those of the signal. The largest value is 8.57 standard deviations, because U1 has 53
/// bits.
void AddBoxMuller(RandomStream& random, double standard_deviation, std::span<double> signal);

/// The next two independent standard normal numbers.
struct NormalPair {
  double first;
  double second;
};
inline NormalPair BoxMuller(RandomStream& random) {
  constexpr double kTwoPi = 6.28318530717958647692;
  const double radius = std::sqrt(-2.0 * std::log(random.UniformAboveZero()));
  const double angle = kTwoPi * random.Uniform();
  return {radius * std::cos(angle), radius * std::sin(angle)};
}

}  // namespace gauntlet::sim
