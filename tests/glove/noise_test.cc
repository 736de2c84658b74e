#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "sim/base/random.h"
#include "sim/glove/noise/box_muller.h"

namespace gauntlet::sim {
namespace {

constexpr int kDraws = 1'000'000;

std::vector<double> BoxMullerDraws(std::uint64_t seed) {
  std::vector<double> draws(kDraws, 0.0);
  RandomStream random(seed, "test", 0);
  AddBoxMuller(random, 1.0, draws);
  return draws;
}

double Mean(const std::vector<double>& values, int power) {
  double sum = 0.0;
  for (const double value : values) sum += std::pow(value, power);
  return sum / static_cast<double>(values.size());
}

double NormalDistribution(double x) { return 0.5 * std::erfc(-x / std::sqrt(2.0)); }

// All tests of randomness here: fixed seed, and a limit that a right generator exceeds with a
// probability of 1e-4 or less (two-sided 3.9 standard errors).
constexpr double kStandardErrors = 3.9;

TEST(BoxMuller, HasTheMomentsOfTheNormalLaw) {
  const std::vector<double> draws = BoxMullerDraws(1);
  const double root = std::sqrt(kDraws);
  // Variances of the sample moments: E[z^2k] - E[z^k]^2 = 1, 2, 15, 96 for k = 1..4.
  EXPECT_NEAR(Mean(draws, 1), 0.0, kStandardErrors * 1.0 / root);
  EXPECT_NEAR(Mean(draws, 2), 1.0, kStandardErrors * std::sqrt(2.0) / root);
  EXPECT_NEAR(Mean(draws, 3), 0.0, kStandardErrors * std::sqrt(15.0) / root);
  EXPECT_NEAR(Mean(draws, 4), 3.0, kStandardErrors * std::sqrt(96.0) / root);
}

TEST(BoxMuller, PassesKolmogorovSmirnovAgainstTheNormalLaw) {
  std::vector<double> draws = BoxMullerDraws(2);
  std::ranges::sort(draws);
  double distance = 0.0;
  for (int i = 0; i < kDraws; ++i) {
    const double expected = NormalDistribution(draws[i]);
    distance = std::max({distance, std::abs(expected - static_cast<double>(i) / kDraws),
                         std::abs(expected - static_cast<double>(i + 1) / kDraws)});
  }
  // Significance 1e-4: 2 exp(-2 d^2 n) = 1e-4.
  EXPECT_LT(distance, std::sqrt(-0.5 * std::log(0.5e-4) / kDraws));
}

TEST(BoxMuller, DrawsAreNotCorrelatedAtAnyLagUpToHundred) {
  const std::vector<double> draws = BoxMullerDraws(3);
  for (int lag = 1; lag <= 100; ++lag) {
    double sum = 0.0;
    for (int i = lag; i < kDraws; ++i) sum += draws[i] * draws[i - lag];
    // 100 lags: 1e-4 over all of them is 1e-6 each, 4.9 standard errors.
    EXPECT_LT(std::abs(sum / kDraws), 4.9 / std::sqrt(kDraws)) << lag;
  }
}

TEST(BoxMuller, FillsAnOddNumberOfSamples) {
  std::vector<double> odd(3, 10.0);
  RandomStream random(1, "test", 0);
  AddBoxMuller(random, 0.5, odd);
  RandomStream again(1, "test", 0);
  const NormalPair first = BoxMuller(again);
  EXPECT_EQ(odd[0], 10.0 + 0.5 * first.first);
  EXPECT_EQ(odd[1], 10.0 + 0.5 * first.second);
  EXPECT_EQ(odd[2], 10.0 + 0.5 * BoxMuller(again).first);
}

}  // namespace
}  // namespace gauntlet::sim
