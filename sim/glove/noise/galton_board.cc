#include "sim/glove/noise/galton_board.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "controller/assert.h"

namespace gauntlet::sim {

int DropGaltonBall(RandomStream& random, int rows) {
  GAUNTLET_ASSERT(rows >= 0);
  int right = 0;
  for (; rows >= 64; rows -= 64) right += std::popcount(random.Bits());
  if (rows > 0) right += std::popcount(random.Bits() >> (64 - rows));
  return right;
}

std::vector<std::int64_t> GaltonHistogram(RandomStream& random, int rows, std::int64_t balls) {
  std::vector<std::int64_t> bins(static_cast<std::size_t>(rows) + 1, 0);
  for (std::int64_t ball = 0; ball < balls; ++ball) {
    ++bins[static_cast<std::size_t>(DropGaltonBall(random, rows))];
  }
  return bins;
}

std::vector<double> GaltonProbabilities(int rows) {
  GAUNTLET_ASSERT(rows >= 0);
  std::vector<double> probabilities;
  for (int bin = 0; bin <= rows; ++bin) {
    const double logarithm = std::lgamma(rows + 1.0) - std::lgamma(bin + 1.0) -
                             std::lgamma(rows - bin + 1.0) - rows * std::log(2.0);
    probabilities.push_back(std::exp(logarithm));
  }
  return probabilities;
}

double GaltonDistanceFromNormal(int rows) {
  double distance = 0.0;
  double sum = 0.0;
  const std::vector<double> probabilities = GaltonProbabilities(rows);
  for (int bin = 0; bin <= rows; ++bin) {
    const double place = (2.0 * bin - rows) / std::sqrt(rows);
    const double normal = 0.5 * std::erfc(-place / std::sqrt(2.0));
    distance = std::max(distance, std::abs(sum - normal));
    sum += probabilities[static_cast<std::size_t>(bin)];
    distance = std::max(distance, std::abs(sum - normal));
  }
  return distance;
}

void AddGalton(RandomStream& random, int rows, int balls, double standard_deviation,
               std::span<double> signal) {
  GAUNTLET_ASSERT(rows > 0 && balls > 0);
  // Balls fall one after another through the same rows: as if there were rows * balls rows.
  const int all_rows = rows * balls;
  const double scale = standard_deviation / std::sqrt(all_rows);
  for (double& value : signal) {
    value += scale * (2 * DropGaltonBall(random, all_rows) - all_rows);
  }
}

}  // namespace gauntlet::sim
