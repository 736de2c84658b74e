#pragma once

#include <cmath>
#include <cstddef>
#include <span>

#include "sim/base/random.h"

namespace gauntlet::sim {

/// Two independent standard normal numbers.
struct NormalPair {
  double first;
  double second;
};

/// The next two normal numbers of a stream, by the basic form of the Box-Muller transform.
///
///     Z0 = sqrt(-2 ln U1) cos(2 pi U2)        U1 in (0, 1], U2 in [0, 1) independent
///     Z1 = sqrt(-2 ln U1) sin(2 pi U2)
///
/// The largest value is 8.57, because U1 has 53 bits. Source: Box and Muller 1958.
inline NormalPair BoxMuller(RandomStream& random) {
  constexpr double kTwoPi = 6.28318530717958647692;
  const double radius = std::sqrt(-2.0 * std::log(random.UniformAboveZero()));
  const double angle = kTwoPi * random.Uniform();
  return {radius * std::cos(angle), radius * std::sin(angle)};
}

/// Adds white Gaussian noise of BoxMuller() to a signal.
///
/// Source: Bai, Jiang, Yokoi, section 2.3.3.1. Units: those of the signal.
inline void AddBoxMuller(RandomStream& random, double standard_deviation,
                         std::span<double> signal) {
  std::size_t i = 0;
  for (; i + 1 < signal.size(); i += 2) {
    const NormalPair pair = BoxMuller(random);
    signal[i] += standard_deviation * pair.first;
    signal[i + 1] += standard_deviation * pair.second;
  }
  if (i < signal.size()) signal[i] += standard_deviation * BoxMuller(random).first;
}

}  // namespace gauntlet::sim
