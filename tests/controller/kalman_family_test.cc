// The relatives of the paper's filter, held against matrices in long double.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <deque>

#include "controller/filters/filter_registry.h"
#include "controller/filters/riccati.h"
#include "controller/filters/steady_gains.h"
#include "tests/controller/test_signal.h"
#include "tests/controller/textbook_kalman.h"
#include "tests/support/gram_schmidt.h"

namespace gauntlet::controller {
namespace {

constexpr int kChannels = 18;
constexpr double kRateHz = 1000.0;

RealMatrix Diagonal(const std::vector<double>& values) {
  RealMatrix matrix = RealMatrix::Zero(values.size(), values.size());
  for (std::size_t i = 0; i < values.size(); ++i) matrix(i, i) = values[i];
  return matrix;
}

TEST(KalmanSteadyFilter, HasTheGainThatTheRecursionSettlesTo) {
  for (const int states : {2, 3}) {
    for (const double q : {1.0, 1e-4, 1e-8}) {
      const KalmanSteadyConfig config{.noise = {.r = {9.86}, .q = {q}}, .states = states};
      const Eigen::ArrayXXd gains = SteadyGains(config, 1, kRateHz);
      TextbookKalman textbook = MakeTextbookKalman(
          1, states, Real(q) * RealMatrix::Identity(states, states), Diagonal({9.86}));
      for (int k = 0; k < 20000; ++k) textbook.Step(Real(0));
      for (int i = 0; i < states; ++i) {
        EXPECT_NEAR(gains(0, i) / static_cast<double>(textbook.gain(i, 0)), 1.0, 1e-10)
            << states << " " << q;
      }
    }
  }
}

TEST(KalmanSteadyFilter, EndsWhereTheFullFilterDoes) {
  const auto steady = MakeFilter(KalmanSteadyConfig{}, kChannels, kRateHz);
  const auto full = MakeFilter(KalmanConfig{}, kChannels, kRateHz);
  const TestSignal input = GloveCounts(2000, kChannels);
  std::vector<double> first(kChannels), second(kChannels);
  for (int k = 0; k < 2000; ++k) {
    steady->Step(RowOf(input, k), first);
    full->Step(RowOf(input, k), second);
  }
  for (int i = 0; i < kChannels; ++i) EXPECT_NEAR(first[i], second[i], 1e-10);
}

TEST(KalmanSteadyFilter, RefusesToStandStill) {
  EXPECT_THROW(MakeFilter({KalmanSteadyConfig{.noise = {.q = {0.0}}}}, kChannels, kRateHz),
               SettingError);
}

TEST(SolveRiccati, LeavesNoResidualForCoupledChannels) {
  // Two channels with correlated noise and motion.
  Eigen::Matrix4d a = Eigen::Matrix4d::Identity();
  a(0, 2) = a(1, 3) = 1.0;
  const Eigen::MatrixXd h = Eigen::MatrixXd::Identity(2, 4);
  Eigen::Matrix2d r;
  r << 4.0, 1.5, 1.5, 9.0;
  Eigen::Matrix4d q = 1e-3 * Eigen::Matrix4d::Identity();
  q(2, 3) = q(3, 2) = 5e-4;
  const Eigen::MatrixXd p = SolveRiccati(a, h, q, r);
  const Eigen::MatrixXd s = h * p * h.transpose() + r;
  const Eigen::MatrixXd updated =
      p - p * h.transpose() * test::SolveByGramSchmidt<Eigen::MatrixXd>(s, h * p).value();
  const Eigen::MatrixXd residual = a * updated * a.transpose() + q - p;
  EXPECT_LE(residual.cwiseAbs().maxCoeff(), 1e-12 * p.cwiseAbs().maxCoeff());
}

TEST(KalmanDenseFilter, EqualsTheChannelwiseFilterWithoutCoupling) {
  const auto dense = MakeFilter(KalmanDenseConfig{}, kChannels, kRateHz);
  const auto channelwise = MakeFilter(KalmanConfig{}, kChannels, kRateHz);
  const TestSignal input = GloveCounts(3000, kChannels);
  std::vector<double> first(kChannels), second(kChannels);
  double worst = 0.0;
  for (int k = 0; k < 3000; ++k) {
    dense->Step(RowOf(input, k), first);
    channelwise->Step(RowOf(input, k), second);
    for (int i = 0; i < kChannels; ++i) {
      worst = std::max(worst, std::abs(first[i] - second[i]) / second[i]);
    }
  }
  EXPECT_LE(worst, 1e-12);
}

TEST(KalmanDenseFilter, FollowsTheBlockEquationsWithCoupledNoise) {
  constexpr int n = 3;
  const std::vector<double> r = {5.0, 2.0, 0.5, 2.0, 7.0, -1.0, 0.5, -1.0, 4.0};
  const std::vector<double> q = {0.02, 0.01, 0.0, 0.01, 0.03, 0.005, 0.0, 0.005, 0.01};
  RealMatrix r_matrix(n, n);
  RealMatrix q_matrix = RealMatrix::Zero(2 * n, 2 * n);
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      r_matrix(i, j) = r[i * n + j];
      q_matrix(i, j) = q_matrix(n + i, n + j) = q[i * n + j];
    }
  }
  TextbookKalman textbook = MakeTextbookKalman(n, 2, q_matrix, r_matrix);
  const auto filter =
      MakeFilter(KalmanDenseConfig{.start = Start::kZero, .r = r, .q = q}, n, kRateHz);
  const TestSignal input = GloveCounts(2000, n);
  std::vector<double> output(n);
  for (int k = 0; k < 2000; ++k) {
    filter->Step(RowOf(input, k), output);
    const RealVector expected = textbook.Step(input.row(k).transpose().cast<Real>());
    for (int i = 0; i < n; ++i) {
      ASSERT_NEAR(output[i] / static_cast<double>(expected[i]), 1.0, 1e-12);
    }
  }
}

TEST(KalmanDenseFilter, RefusesMatricesThatAreNoCovariances) {
  const auto is_refused = [](const KalmanDenseConfig& config, int channels) {
    try {
      MakeFilter({config}, channels, kRateHz);
    } catch (const SettingError&) {
      return true;
    }
    return false;
  };
  EXPECT_TRUE(is_refused({.r = {1.0, 2.0, 2.0, 1.0}}, 2));  // indefinite
  EXPECT_TRUE(is_refused({.r = {1.0, 0.5, 0.1, 1.0}}, 2));  // not symmetric
  EXPECT_TRUE(is_refused({.r = {1.0, 1.0, 1.0}}, 2));       // neither 1, 2 nor 4
  EXPECT_TRUE(is_refused({.r = {1.0}, .q = {-1.0}}, 2));
  EXPECT_TRUE(is_refused({.r = {1.0}}, 129));
  EXPECT_FALSE(is_refused({.r = {1.0, 0.5, 0.5, 1.0}}, 2));
}

/// A random walk of the velocity, with measurement noise: the model itself.
std::vector<double> ModelSignal(double r, double q, int samples, std::uint64_t seed) {
  TestNoise noise(seed);
  double position = 500.0;
  double velocity = 0.0;
  std::vector<double> signal;
  for (int k = 0; k < samples; ++k) {
    position += velocity + std::sqrt(q) * noise.Normal();
    velocity += std::sqrt(q) * noise.Normal();
    signal.push_back(position + std::sqrt(r) * noise.Normal());
  }
  return signal;
}

TEST(KalmanAdaptiveFilter, LearnsTheNoiseOfItsModel) {
  constexpr double kTrueR = 16.0;
  constexpr double kTrueQ = 0.01;
  const KalmanAdaptiveConfig config{.noise = {.r = {1.0}, .q = {1.0}}, .memory = 5000.0};
  const auto filter = MakeKalmanAdaptiveFilter(config, 1, kRateHz);
  for (const double sample : ModelSignal(kTrueR, kTrueQ, 100000, 9)) {
    double output = 0.0;
    filter->Step({&sample, 1}, {&output, 1});
  }
  EXPECT_NEAR(filter->r(0), kTrueR, 0.1 * kTrueR);
  EXPECT_NEAR(std::log(filter->q(0) / kTrueQ), 0.0, std::log(1.6));
}

TEST(KalmanAdaptiveFilter, StaysWithinItsRange) {
  const KalmanAdaptiveConfig config{.noise = {.r = {4.0}, .q = {1.0}}, .memory = 50.0, .range = 10};
  const auto filter = MakeKalmanAdaptiveFilter(config, 1, kRateHz);
  const double rest = 500.0;
  double output = 0.0;
  for (int k = 0; k < 100000; ++k) filter->Step({&rest, 1}, {&output, 1});
  EXPECT_GE(filter->r(0), 0.4);
  EXPECT_LE(filter->r(0), 40.0);
  EXPECT_GE(filter->q(0), 0.1);
  EXPECT_LE(filter->q(0), 10.0);
  EXPECT_NEAR(output, rest, 1e-9);
}

}  // namespace
}  // namespace gauntlet::controller
