#include "controller/filters/moving_average_filter.h"

#include <gtest/gtest.h>

#include "controller/filters/filter_registry.h"
#include "tests/controller/test_signal.h"

namespace gauntlet::controller {
namespace {

TEST(MovingAverageFilter, AveragesTheSamplesThereAreUntilTheWindowIsFull) {
  const auto filter = MakeFilter(MovingAverageConfig{.window = 3}, 1, 1000.0);
  const double input[] = {3.0, 6.0, 12.0, 0.0};
  const double expected[] = {3.0, 4.5, 7.0, 6.0};
  for (int k = 0; k < 4; ++k) {
    double output = 0.0;
    filter->Step({&input[k], 1}, {&output, 1});
    EXPECT_EQ(output, expected[k]);
  }
}

TEST(MovingAverageFilter, DoesNotDriftOverThePapersExperiment) {
  constexpr int kSamples = 94096;
  constexpr int kWindow = 37;
  const auto filter = MakeFilter(MovingAverageConfig{.window = kWindow}, 1, 1000.0);
  TestNoise noise(3);
  std::vector<double> input(kSamples);
  double worst = 0.0;
  for (int k = 0; k < kSamples; ++k) {
    // Values of very different size: a plain running sum would lose the small ones.
    input[k] = (1.0 + noise.Uniform()) * (k % 1000 == 0 ? 1e6 : 1e-3);
    double output = 0.0;
    filter->Step({&input[k], 1}, {&output, 1});
    long double sum = 0;
    const int count = std::min(k + 1, kWindow);
    for (int j = 0; j < count; ++j) sum += input[k - j];
    const long double mean = sum / count;
    worst = std::max<double>(worst, std::abs((output - mean) / mean));
  }
  EXPECT_LE(worst, 1e-12);
}

}  // namespace
}  // namespace gauntlet::controller
