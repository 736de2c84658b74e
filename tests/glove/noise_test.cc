#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <complex>
#include <string>
#include <unsupported/Eigen/FFT>
#include <vector>

#include "sim/base/normal_pair.h"
#include "sim/base/random.h"
#include "sim/glove/noise/add_noise.h"
#include "sim/glove/noise/coloured_noise.h"
#include "sim/glove/noise/galton_board.h"

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

std::vector<double> GaltonDraws(std::uint64_t seed, int rows, int balls) {
  std::vector<double> draws(kDraws, 0.0);
  RandomStream random(seed, "test", 0);
  AddGalton(random, rows, balls, 1.0, draws);
  return draws;
}

TEST(Galton, FollowsItsBinomialLawExactly) {
  for (const int rows : {1, 8, 63, 64, 100}) {
    RandomStream random(11, "test", static_cast<std::uint64_t>(rows));
    const auto bins = GaltonHistogram(random, rows, kDraws);
    const auto probabilities = GaltonProbabilities(rows);
    double chi_square = 0.0, sum = 0.0;
    int degrees = -1;
    for (int bin = 0; bin <= rows; ++bin) {
      const double expected = probabilities[bin] * kDraws;
      sum += probabilities[bin];
      if (expected < 5.0) continue;  // too rare for the chi-square law
      chi_square += std::pow(static_cast<double>(bins[bin]) - expected, 2) / expected;
      ++degrees;
    }
    EXPECT_NEAR(sum, 1.0, 1e-12);
    // Significance about 1e-4: mean + 3.72 deviations, and 9 for the skewness of few degrees.
    EXPECT_LT(chi_square, degrees + 3.72 * std::sqrt(2.0 * degrees) + 9.0) << rows;
  }
}

TEST(Galton, ProbabilitiesAreThoseOfPascalsTriangle) {
  const auto probabilities = GaltonProbabilities(4);
  const double expected[] = {1 / 16.0, 4 / 16.0, 6 / 16.0, 4 / 16.0, 1 / 16.0};
  for (int bin = 0; bin <= 4; ++bin) EXPECT_NEAR(probabilities[bin], expected[bin], 1e-14);
}

TEST(Galton, DistanceFromTheNormalLawShrinksAsTheorySays) {
  // The lattice alone: half of the highest bin, 1 / sqrt(2 pi rows).
  for (const int rows : {16, 64, 256, 1024}) {
    const double theory = 1.0 / std::sqrt(2.0 * 3.14159265358979323846 * rows);
    EXPECT_NEAR(GaltonDistanceFromNormal(rows) / theory, 1.0, 2.0 / rows) << rows;
  }
}

TEST(Galton, NoiseHasTheMomentsOfTheBoard) {
  const std::vector<double> draws = GaltonDraws(12, 64, 4);
  const double root = std::sqrt(kDraws);
  EXPECT_NEAR(Mean(draws, 1), 0.0, kStandardErrors / root);
  EXPECT_NEAR(Mean(draws, 2), 1.0, kStandardErrors * std::sqrt(2.0) / root);
  EXPECT_NEAR(Mean(draws, 3), 0.0, kStandardErrors * std::sqrt(15.0) / root);
  // A sum of 256 signs has a kurtosis of 3 - 2 / 256.
  EXPECT_NEAR(Mean(draws, 4), 3.0 - 2.0 / 256, kStandardErrors * std::sqrt(96.0) / root);
}

TEST(Galton, DrawsAreNotCorrelatedAtAnyLagUpToHundred) {
  const std::vector<double> draws = GaltonDraws(13, 64, 4);
  for (int lag = 1; lag <= 100; ++lag) {
    double sum = 0.0;
    for (int i = lag; i < kDraws; ++i) sum += draws[i] * draws[i - lag];
    EXPECT_LT(std::abs(sum / kDraws), 4.9 / std::sqrt(kDraws)) << lag;
  }
}

TEST(ColouredNoise, PinkFallsByThreeDecibelsAnOctaveAndHasItsVariance) {
  constexpr int kSamples = 1 << 19;
  double variance = 0.0;
  std::vector<double> octaves(8, 0.0);  // from 0.5 Hz on
  for (int channel = 0; channel < 4; ++channel) {
    std::vector<double> signal(kSamples, 0.0);
    RandomStream random(21, "test", channel);
    AddPinkNoise(random, 2.0, 1000.0, signal);
    variance += Mean(signal, 2) / 4;
    std::vector<std::complex<double>> spectrum;
    Eigen::FFT<double>().fwd(spectrum, signal);
    for (int k = 1; k < kSamples / 2; ++k) {
      const double octave = std::log2(k * 1000.0 / kSamples / 0.5);
      if (octave >= 0 && octave < 8) octaves[static_cast<int>(octave)] += std::norm(spectrum[k]);
    }
  }
  EXPECT_NEAR(variance, 4.0, 0.3);
  // 1/f noise has the same power in every octave: 0.5 dB of ripple is 12 %, the rest statistics.
  for (const double power : octaves) EXPECT_NEAR(power / octaves[4], 1.0, 0.25);
}

TEST(ColouredNoise, HumHasItsAmplitudeAndFrequency) {
  std::vector<double> signal(1000, 0.0);
  RandomStream random(1, "test", 0);
  AddMainsHum(random, 3.0, 50.0, 1000.0, signal);
  EXPECT_NEAR(Mean(signal, 2), 4.5, 1e-9);
  for (int i = 20; i < 1000; ++i) EXPECT_NEAR(signal[i], signal[i - 20], 1e-9);
}

Signal NoiseOf(const NoiseConfig& config, int samples, int bits = 10) {
  Signal counts = Signal::Zero(samples, 18);
  AddNoise(config, {.bits = {static_cast<double>(bits)}}, 1000.0, 9, counts);
  return counts;
}

TEST(Noise, HasTheCovarianceBetweenChannelsThatIsGiven) {
  NoiseConfig config;
  Eigen::MatrixXd covariance = 4.0 * Eigen::MatrixXd::Identity(18, 18);
  for (int c = 0; c + 1 < 18; ++c) covariance(c, c + 1) = covariance(c + 1, c) = 1.5;
  config.covariance_counts2.assign(covariance.reshaped().begin(), covariance.reshaped().end());
  config.Check();
  const Signal noise = NoiseOf(config, 200000);
  const Eigen::MatrixXd measured = noise.transpose() * noise / 200000.0;
  // Standard error of an element: at most 4 sqrt(2 / 200,000) = 0.0126; 171 of them, 4.5 errors.
  EXPECT_LT((measured - covariance).cwiseAbs().maxCoeff(), 4.5 * 0.0126);
}

TEST(Noise, OfDifferentChannelsIsIndependent) {
  NoiseConfig config;
  config.variance_counts2 = {1.0};
  const Signal noise = NoiseOf(config, 200000);
  Eigen::MatrixXd correlation = noise.transpose() * noise / 200000.0;
  correlation.diagonal().setZero();
  EXPECT_LT(correlation.cwiseAbs().maxCoeff(), 4.5 / std::sqrt(200000.0));
}

TEST(Noise, OfACoarserConverterIsTheSameVoltage) {
  const NoiseConfig config;
  EXPECT_LT((NoiseOf(config, 100, 8) * (1023.0 / 255.0) - NoiseOf(config, 100, 10)).norm(), 1e-9);
}

TEST(Noise, RejectsWhatIsNoCovariance) {
  NoiseConfig config;
  config.covariance_counts2.assign(324, 0.0);
  EXPECT_THROW(config.Check(), controller::SettingError);  // not positive definite
  config.covariance_counts2.assign(100, 1.0);
  EXPECT_THROW(config.Check(), controller::SettingError);
}

}  // namespace
}  // namespace gauntlet::sim
