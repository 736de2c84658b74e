#include "sim/score/low_pass.h"

#include <gtest/gtest.h>

#include <limits>

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

/// Channel by channel, row by row.
void ExpectConvolutions(const LowPass& low_pass, const Signal& signal) {
  Fourier fourier;
  const FilteredSignal below = Filter(low_pass, Band::kBelow, signal, fourier);
  const FilteredSignal above = Filter(low_pass, Band::kAbove, signal, fourier);
  ASSERT_EQ(below.first_sample, low_pass.reach());
  ASSERT_EQ(below.values.rows(), signal.rows() - 2 * low_pass.reach());
  for (int channel = 0; channel < signal.cols(); ++channel) {
    const auto values = signal.col(channel);
    for (int row = 0; row < below.values.rows(); ++row) {
      const int n = row + below.first_sample;
      double sum = low_pass.weights[0] * values[n];
      for (int k = 1; k <= low_pass.reach(); ++k) {
        sum += low_pass.weights[k] * (values[n + k] + values[n - k]);
      }
      ASSERT_NEAR(below.values(row, channel), sum, 1e-12) << n;
      ASSERT_NEAR(below.values(row, channel) + above.values(row, channel), values[n], 1e-12) << n;
    }
  }
}

TEST(LowPass, FilterIsTheConvolutionWhereItHasAValue) {
  const LowPass low_pass = DesignLowPass(20.0, 40.0, 1000.0);
  const int block = FastTransformSize(8 * (2 * low_pass.reach() + 1));
  for (const int samples : {900, block - 1, block, block + 1, 2 * block, 5000}) {
    Signal signal(samples, 3);
    for (int c = 0; c < 3; ++c) signal.col(c) = OneChannel(Noise(samples, 21 + c)).col(0);
    SCOPED_TRACE(samples);
    ExpectConvolutions(low_pass, signal);
  }
}

TEST(LowPass, FilterKeepsWhatIsNotANumberToItsChannel) {
  const LowPass low_pass = DesignLowPass(20.0, 40.0, 1000.0);
  Signal signal(5000, 2);
  for (int c = 0; c < 2; ++c) signal.col(c) = OneChannel(Noise(5000, 21 + c)).col(0);
  Fourier fourier;
  const Signal good = Filter(low_pass, Band::kBelow, signal, fourier).values;
  signal(4999, 1) = std::numeric_limits<double>::quiet_NaN();
  const Signal spoilt = Filter(low_pass, Band::kBelow, signal, fourier).values;
  EXPECT_LT((good.col(0) - spoilt.col(0)).cwiseAbs().maxCoeff(), 1e-12);
  EXPECT_TRUE(spoilt.col(1).array().isNaN().all());
}

TEST(LowPass, ReachIsThatOfTheDesign) {
  for (const double transition_hz : {4.0, 10.0, 40.0}) {
    EXPECT_EQ(LowPassReach(transition_hz, 1000.0),
              DesignLowPass(20.0, transition_hz, 1000.0).reach());
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
