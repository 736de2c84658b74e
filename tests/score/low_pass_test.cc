#include "sim/score/low_pass.h"

#include <gtest/gtest.h>

#include "tests/score/signals.h"

namespace gauntlet::sim {
namespace {

/// Gain at a frequency, from the weights.
double Gain(const LowPass& low_pass, double hz, double rate_hz) {
  double gain = low_pass.weights[0];
  for (int n = 1; n <= low_pass.reach(); ++n) {
    gain += 2.0 * low_pass.weights[n] * std::cos(2.0 * kPi * hz / rate_hz * n);
  }
  return gain;
}

TEST(LowPass, HasItsBandsAndHalfTheAmplitudeAtTheCutoff) {
  for (const double rate_hz : {100.0, 1000.0}) {
    const LowPass low_pass = DesignLowPass(20.0, 10.0, rate_hz);
    EXPECT_NEAR(Gain(low_pass, 0.0, rate_hz), 1.0, 1e-12);
    EXPECT_NEAR(Gain(low_pass, 20.0, rate_hz), 0.5, 5e-3);
    for (double hz = 0.0; hz <= 15.0; hz += 0.1) {
      EXPECT_NEAR(Gain(low_pass, hz, rate_hz), 1.0, 1.5e-4) << hz;
    }
    for (double hz = 25.0; hz <= rate_hz / 2.0; hz += 0.1) {
      EXPECT_NEAR(Gain(low_pass, hz, rate_hz), 0.0, 1.5e-4) << hz;
    }
  }
}

TEST(LowPass, FilterIsTheConvolutionWhereItHasAValue) {
  const auto noise = Noise(900, 21);
  const LowPass low_pass = DesignLowPass(20.0, 40.0, 1000.0);
  Fourier fourier;
  const FilteredSignal below = Filter(low_pass, Band::kBelow, OneChannel(noise), fourier);
  const FilteredSignal above = Filter(low_pass, Band::kAbove, OneChannel(noise), fourier);
  ASSERT_EQ(below.first_sample, low_pass.reach());
  ASSERT_EQ(below.values.rows(), 900 - 2 * low_pass.reach());
  for (int row = 0; row < below.values.rows(); ++row) {
    const int n = row + below.first_sample;
    double sum = low_pass.weights[0] * noise[n];
    for (int k = 1; k <= low_pass.reach(); ++k) {
      sum += low_pass.weights[k] * (noise[n + k] + noise[n - k]);
    }
    ASSERT_NEAR(below.values(row, 0), sum, 1e-12);
    ASSERT_NEAR(below.values(row, 0) + above.values(row, 0), noise[n], 1e-12);
  }
}

TEST(LowPass, FilterOfAShortSignalHasNoRows) {
  const LowPass low_pass = DesignLowPass(20.0, 40.0, 1000.0);
  Fourier fourier;
  EXPECT_EQ(
      Filter(low_pass, Band::kBelow, Signal::Zero(2 * low_pass.reach(), 3), fourier).values.rows(),
      0);
  EXPECT_EQ(Filter(low_pass, Band::kBelow, Signal(0, 3), fourier).values.cols(), 3);
}

}  // namespace
}  // namespace gauntlet::sim
