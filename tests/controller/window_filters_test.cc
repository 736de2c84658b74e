// Filters that look at the last samples, each against its definition.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "controller/filters/end_point_fit.h"
#include "controller/filters/filter_registry.h"
#include "tests/controller/test_signal.h"

namespace gauntlet::controller {
namespace {

constexpr double kRateHz = 1000.0;

std::vector<double> Filtered(const FilterConfig& config, const std::vector<double>& input) {
  const auto filter = MakeFilter(config, 1, kRateHz);
  std::vector<double> output(input.size());
  for (std::size_t k = 0; k < input.size(); ++k) filter->Step({&input[k], 1}, {&output[k], 1});
  return output;
}

/// Small whole numbers, so that equal values are frequent.
std::vector<double> RoughSignal(int samples, std::uint64_t seed) {
  TestNoise noise(seed);
  std::vector<double> signal;
  for (int k = 0; k < samples; ++k) signal.push_back(std::floor(9.0 * noise.Uniform()) - 3.0);
  return signal;
}

double MedianOf(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const std::size_t n = values.size();
  return 0.5 * (values[(n - 1) / 2] + values[n / 2]);
}

std::vector<double> WindowAt(const std::vector<double>& signal, std::size_t k, int length) {
  const std::size_t first = k + 1 >= static_cast<std::size_t>(length) ? k + 1 - length : 0;
  return {signal.begin() + first, signal.begin() + k + 1};
}

TEST(MedianFilter, IsTheMiddleOfTheSortedWindow) {
  // Above 128 the order is kept by place: each parity, and windows that never become full.
  for (const int window : {1, 2, 3, 8, 21, 128, 129, 130, 255, 400, 10001}) {
    const std::vector<double> input = RoughSignal(1500, 100 + window);
    const std::vector<double> output = Filtered({MedianConfig{.window = window}}, input);
    for (std::size_t k = 0; k < input.size(); ++k) {
      ASSERT_EQ(output[k], MedianOf(WindowAt(input, k, window))) << window << " at " << k;
    }
  }
}

TEST(HampelFilter, FollowsItsDefinition) {
  for (const int window : {1, 2, 3, 6, 7, 11, 100, 128, 129, 256}) {
    const std::vector<double> input = RoughSignal(700, 200 + window);
    const HampelConfig config{.window = window, .threshold_sigma = 0.9};
    const std::vector<double> output = Filtered({config}, input);
    int replaced = 0;
    for (std::size_t k = 0; k < input.size(); ++k) {
      std::vector<double> samples = WindowAt(input, k, window);
      const double median = MedianOf(samples);
      for (double& sample : samples) sample = std::abs(sample - median);
      const double deviation = MedianOf(samples);
      const double limit = deviation > 0.0 ? 0.9 * 1.4826 * deviation : 1.0;  // whole numbers
      const bool outlier = std::abs(input[k] - median) > limit;
      replaced += outlier;
      ASSERT_EQ(output[k], outlier ? median : input[k]) << window << " at " << k;
    }
    EXPECT_GT(replaced, window > 3 ? 20 : -1);
  }
}

TEST(HampelFilter, RemovesSpikesAndLeavesTheRestAlone) {
  TestNoise noise(4);
  std::vector<double> input;
  for (int k = 0; k < 2000; ++k) input.push_back(500.0 + noise.Normal());
  std::vector<double> spiked = input;
  for (int k = 100; k < 2000; k += 100) spiked[k] += 300.0;
  const std::vector<double> output = Filtered({HampelConfig{.threshold_sigma = 6.0}}, spiked);
  int changed = 0;
  for (int k = 20; k < 2000; ++k) {
    EXPECT_NEAR(output[k], 500.0, 6.0);
    changed += k % 100 != 0 && output[k] != spiked[k];
  }
  EXPECT_LT(changed, 40);
}

TEST(MedianFilter, ForgetsOneChannelOfALongWindowAlone) {
  const std::vector<double> first = RoughSignal(1000, 31);
  const std::vector<double> second = RoughSignal(1000, 32);
  const auto filter = MakeFilter(MedianConfig{.window = 201}, 2, kRateHz);
  constexpr int kReset = 333;  // the window is full, and its oldest place is none of the first
  for (int k = 0; k < 1000; ++k) {
    if (k == kReset) filter->ResetChannel(1);
    const std::vector<double> input = {first[k], second[k]};
    std::vector<double> output(2);
    filter->Step(input, output);
    ASSERT_EQ(output[0], MedianOf(WindowAt(first, k, 201)));
    const int length = k < kReset ? 201 : std::min(201, k - kReset + 1);
    ASSERT_EQ(output[1], MedianOf(WindowAt(second, k, length))) << k;
  }
}

/// A sensor at rest: now and then its last digit is one step higher.
std::vector<double> Resting(double at, double step) {
  TestNoise noise(7);
  std::vector<double> input;
  for (int k = 0; k < 400; ++k) input.push_back(at + (noise.Uniform() < 0.4 ? step : 0.0));
  return input;
}

TEST(HampelFilter, LeavesTheFlickerOfACountAlone) {
  for (const int window : {11, 10, 101, 201}) {
    const std::vector<double> input = Resting(500.0, 1.0);
    EXPECT_EQ(Filtered({HampelConfig{.window = window}}, input), input) << window;
  }
}

TEST(HampelFilter, LearnsTheStepOfOtherUnits) {
  for (const int window : {11, 10}) {
    const std::vector<double> input = Resting(31.25, 0.0625);
    const std::vector<double> output = Filtered({HampelConfig{.window = window}}, input);
    int changed = 0;
    for (int k = 0; k < 400; ++k) changed += output[k] != input[k];
    EXPECT_LT(changed, 20) << window;  // those before the first step of the median
    for (int k = 100; k < 400; ++k) ASSERT_EQ(output[k], input[k]) << window << " at " << k;
  }
}

TEST(HampelFilter, RemovesSpikesOfARestingSensor) {
  for (const double at : {500.0, 31.25}) {
    std::vector<double> input(400, at);
    for (int k = 7; k < 400; k += 20) input[k] += 2.0;
    EXPECT_EQ(Filtered({HampelConfig{}}, input), std::vector<double>(400, at)) << at;
  }
}

TEST(SavitzkyGolayFilter, ReproducesPolynomialsOfItsOrder) {
  for (int order = 0; order <= 5; ++order) {
    std::vector<double> input;
    for (int k = 0; k < 200; ++k) input.push_back(1.0 + std::pow(0.02 * (k - 50), order));
    const auto output = Filtered({SavitzkyGolayConfig{.window = 31, .order = order}}, input);
    for (int k = 31; k < 200; ++k) {
      ASSERT_NEAR(output[k], input[k], 1e-10 * std::abs(input[k])) << order;
    }
  }
}

TEST(SavitzkyGolayFilter, PassesSamplesThroughUntilItsWindowIsFull) {
  const std::vector<double> input = RoughSignal(40, 5);
  const auto output = Filtered({SavitzkyGolayConfig{.window = 21, .order = 2}}, input);
  for (int k = 0; k < 20; ++k) EXPECT_EQ(output[k], input[k]);
  EXPECT_NE(output[20], input[20]);
}

TEST(EndPointWeights, AreThoseOfTheLinearRegression) {
  // Value at the newest sample of the line through m samples: (2 (2m - 1) - 6 j) / (m (m + 1)).
  // Slope: 6 (m - 1 - 2 j) / (m (m^2 - 1)).
  for (const int m : {2, 5, 41}) {
    const Eigen::ArrayXd value = EndPointWeights(m, 1);
    const Eigen::ArrayXd slope = EndPointWeights(m, 1, 1);
    for (int j = 0; j < m; ++j) {
      EXPECT_NEAR(value[j], (2.0 * (2 * m - 1) - 6.0 * j) / (m * (m + 1.0)), 1e-15);
      EXPECT_NEAR(slope[j], 6.0 * (m - 1 - 2 * j) / (m * (1.0 * m * m - 1.0)), 1e-15);
    }
  }
}

TEST(EndPointWeights, GiveTheSecondDerivativeOfAParabola) {
  const Eigen::ArrayXd weights = EndPointWeights(30, 2, 2);
  double sum = 0.0;
  for (int j = 0; j < 30; ++j) sum += weights[j] * (3.0 - 2.0 * j + 0.7 * j * j);
  EXPECT_NEAR(sum, 1.4, 1e-11);
}

}  // namespace
}  // namespace gauntlet::controller
