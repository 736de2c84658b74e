#include "sim/score/fourier.h"

#include <gtest/gtest.h>

#include "tests/score/signals.h"

namespace gauntlet::sim {
namespace {

Fourier::Values NoiseValues(int size) {
  const auto noise = Noise(2 * size, 5);
  Fourier::Values values(size);
  for (int n = 0; n < size; ++n) values[n] = {noise[2 * n], noise[2 * n + 1]};
  return values;
}

/// sum over n of values[n] exp(2 pi i turns k n / N).
std::complex<double> Sum(const Fourier::Values& values, double turns, int k) {
  const int size = static_cast<int>(values.size());
  std::complex<double> sum = 0.0;
  for (int n = 0; n < size; ++n) {
    sum += values[n] * std::polar(1.0, 2.0 * kPi * turns * (k * n % size) / size);
  }
  return sum;
}

TEST(Fourier, AgreesWithTheDefinitionAtLengthsOfAllKinds) {
  Fourier fourier;
  for (const int size : {1, 2, 3, 4, 5, 6, 7, 8, 9, 16, 25, 49, 60, 77, 97, 128, 135, 1000, 1001}) {
    const Fourier::Values input = NoiseValues(size);
    Fourier::Values forward = input;
    fourier.Forward(forward);
    Fourier::Values inverse = input;
    fourier.Inverse(inverse);
    for (int k = 0; k < size; ++k) {
      EXPECT_LT(std::abs(forward[k] - Sum(input, -1.0, k)), 1e-13 * size) << size << " " << k;
      EXPECT_LT(std::abs(inverse[k] - Sum(input, 1.0, k) / static_cast<double>(size)), 1e-13)
          << size << " " << k;
    }
  }
}

TEST(Fourier, OfOneLengthDoesNotDependOnThoseBefore) {
  Fourier used;
  for (const int size : {97200, 1024, 7}) {
    Fourier::Values values = NoiseValues(size);
    used.Forward(values);
  }
  Fourier::Values first = NoiseValues(600);
  Fourier::Values second = first;
  used.Forward(first);
  Fourier().Forward(second);
  EXPECT_EQ(first, second);
}

TEST(Fourier, InverseGivesTheInputBack) {
  const Fourier::Values input = NoiseValues(97200);
  Fourier::Values values = input;
  Fourier fourier;
  fourier.Forward(values);
  fourier.Inverse(values);
  for (std::size_t n = 0; n < input.size(); ++n) ASSERT_LT(std::abs(values[n] - input[n]), 1e-12);
}

TEST(Fourier, OfRealValuesIsTheLowerHalf) {
  for (const int size : {1, 2, 7, 16, 30, 75, 1024}) {
    const auto real = Noise(size, 7);
    Fourier::Values complex(real.begin(), real.end());
    Fourier::Values half;
    Fourier fourier;
    fourier.Forward(real, half);
    fourier.Forward(complex);
    ASSERT_EQ(half.size(), size / 2 + 1u);
    for (int k = 0; k <= size / 2; ++k) EXPECT_LT(std::abs(half[k] - complex[k]), 1e-12);
  }
}

TEST(Fourier, InverseOfTheLowerHalfGivesRealValuesBack) {
  for (const int size : {1, 2, 4, 30, 75, 1024, 48600}) {
    const auto real = Noise(size, 7);
    Fourier::Values half;
    Fourier fourier;
    fourier.Forward(real, half);
    std::vector<double> back(size);
    fourier.Inverse(half, back);
    for (int n = 0; n < size; ++n) ASSERT_NEAR(back[n], real[n], 1e-12) << size;
  }
}

TEST(Fourier, FastSizesAreLargeEnoughNearAndSmooth) {
  for (int size = 1; size < 200000; size = size * 5 / 4 + 1) {
    const int fast = FastTransformSize(size);
    EXPECT_GE(fast, size);
    EXPECT_LE(fast, size * 4 / 3 + 4);
    int rest = fast;
    for (const int factor : {2, 3, 5}) {
      while (rest % factor == 0) rest /= factor;
    }
    EXPECT_EQ(rest, 1);
  }
}

}  // namespace
}  // namespace gauntlet::sim
