#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "sim/base/random.h"

namespace gauntlet::sim {

/// A ball falls through `rows` rows of pins and goes left or right at each: its bin is the number
/// of times it went right, 0 .. rows, binomial with probability 1/2.
///
/// Source: Bai, Jiang, Yokoi, section 2.3.3.2; Galton 1889.
int DropGaltonBall(RandomStream& random, int rows);

/// How many of `balls` balls fall into each of the rows + 1 bins.
std::vector<std::int64_t> GaltonHistogram(RandomStream& random, int rows, std::int64_t balls);

/// Exact probability of each bin: C(rows, bin) / 2^rows.
std::vector<double> GaltonProbabilities(int rows);

/// Largest distance of the board's distribution function from the normal law with the same mean and
/// variance. In theory, for many rows, half of the highest bin: 1 / sqrt(2 pi rows).
double GaltonDistanceFromNormal(int rows);

/// Adds white, nearly Gaussian noise: each value is the mean place of `balls` balls, scaled to the
/// standard deviation. Values lie 2 / sqrt(rows balls) standard deviations apart and within
/// sqrt(rows balls) of them.
void AddGalton(RandomStream& random, int rows, int balls, double standard_deviation,
               std::span<double> signal);

}  // namespace gauntlet::sim
