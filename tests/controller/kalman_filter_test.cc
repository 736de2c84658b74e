#include "controller/filters/kalman_filter.h"

#include <gtest/gtest.h>

#include "controller/filters/filter_registry.h"
#include "tests/controller/test_signal.h"
#include "tests/controller/textbook_kalman.h"

namespace gauntlet::controller {
namespace {

constexpr int kChannels = 18;
/// Largest difference from the textbook relative to the signal, over all channels and samples.
double LargestRelativeError(const KalmanConfig& config, const RealMatrix& q, int samples) {
  const TestSignal input = GloveCounts(samples, kChannels);
  const auto filter = MakeFilter(config, kChannels, 1000.0);
  std::vector<TextbookKalman> textbook;
  for (const double r : config.noise.r) {
    textbook.push_back(MakeTextbookKalman(1, config.states, q, RealMatrix::Constant(1, 1, r)));
  }
  Eigen::RowVectorXd output(kChannels);
  double worst = 0.0;
  for (int k = 0; k < samples; ++k) {
    filter->Step(RowOf(input, k), {output.data(), kChannels});
    for (int i = 0; i < kChannels; ++i) {
      Real expected = input(k, i);
      if (config.start == Start::kFirst && k == 0) {
        textbook[i].x[0] = expected;
      } else {
        expected = textbook[i].Step(expected);
      }
      worst = std::max<double>(worst, std::abs((output[i] - expected) / expected));
    }
  }
  return worst;
}

constexpr int kSamplesOfThePaper = 94096;

TEST(KalmanFilter, FollowsThePapersEquationsOverThePapersExperiment) {
  const RealMatrix q = RealMatrix::Identity(2, 2);
  EXPECT_LE(LargestRelativeError({}, q, kSamplesOfThePaper), 1e-12);
  EXPECT_LE(LargestRelativeError({.start = Start::kZero}, q, kSamplesOfThePaper), 1e-12);
}

TEST(KalmanFilter, UsesTheAccelerationInput) {
  const KalmanConfig config{.noise = {.r = {10.0}, .q = {1e-6}}};
  const auto filter = MakeKalmanFilter(config, 1, 1000.0);
  TextbookKalman textbook = MakeTextbookKalman(1, 2, Real(1e-6) * RealMatrix::Identity(2, 2),
                                               RealMatrix::Constant(1, 1, 10));
  RealVector b(2);
  b << Real(0.5), 1;
  double output = 0.0;
  for (int k = 0; k < 500; ++k) {
    const double z = 0.01 * k * k;
    const double u = 0.02;  // the second difference of z
    filter->StepWithAcceleration({&z, 1}, {&u, 1}, {&output, 1});
    if (k == 0) continue;
    const Real expected = textbook.Step(RealVector::Constant(1, z), b * Real(u))[0];
    EXPECT_NEAR(output, static_cast<double>(expected), 1e-9 * (1.0 + z));
  }
  // A parabola with known acceleration is followed without lag once the velocity is found.
  EXPECT_NEAR(output, 0.01 * 499 * 499, 0.5);
}

TEST(KalmanFilter, EstimatesTheAccelerationInputItself) {
  // On a parabola the estimate is exact, so that a slow filter follows without lag.
  const KalmanConfig with{.noise = {.r = {10.0}, .q = {1e-6}}, .acceleration_window = 20};
  const KalmanConfig without{.noise = {.r = {10.0}, .q = {1e-6}}};
  const auto aware = MakeFilter(with, 1, 1000.0);
  const auto unaware = MakeFilter(without, 1, 1000.0);
  double z = 0.0;
  double output_aware = 0.0;
  double output_unaware = 0.0;
  for (int k = 0; k < 2000; ++k) {
    z = 0.01 * k * k;
    aware->Step({&z, 1}, {&output_aware, 1});
    unaware->Step({&z, 1}, {&output_unaware, 1});
  }
  EXPECT_NEAR(output_aware, z, 1e-3);
  EXPECT_GT(std::abs(output_unaware - z), 10.0);
}

TEST(KalmanFilter, StartsAtTheFirstSampleOrAtZero) {
  const double z = 400.0;
  double output = 0.0;
  MakeFilter(KalmanConfig{.noise = {.r = {10.0}}}, 1, 1000.0)->Step({&z, 1}, {&output, 1});
  EXPECT_EQ(output, 400.0);
  // From zero with P = I: P_11^- = 1 + 1 + q = 3, K_1 = 3 / 13.
  MakeFilter(KalmanConfig{.start = Start::kZero, .noise = {.r = {10.0}}}, 1, 1000.0)
      ->Step({&z, 1}, {&output, 1});
  EXPECT_NEAR(output, 400.0 * 3.0 / 13.0, 1e-12);
}

/// With Q = I and the paper's R the gain on position settles between 0.43 and 0.63: the honest
/// reading of the paper's filter.
TEST(KalmanFilter, HasTheGainThatThePapersNumbersGive) {
  const auto filter = MakeKalmanFilter({}, kChannels, 1000.0);
  std::vector<double> input(kChannels, 0.0);
  std::vector<double> output(kChannels);
  for (int k = 0; k < 200; ++k) filter->Step(input, output);
  std::fill(input.begin(), input.end(), 1.0);
  filter->Step(input, output);
  EXPECT_NEAR(*std::min_element(output.begin(), output.end()), 0.43, 0.005);
  EXPECT_NEAR(*std::max_element(output.begin(), output.end()), 0.63, 0.005);
}

}  // namespace
}  // namespace gauntlet::controller
