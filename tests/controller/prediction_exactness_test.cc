// Predictors against their own definitions in long double: 1e-12 of the angle, at every sample.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <functional>
#include <numbers>
#include <vector>

#include "controller/filters/steady_gains.h"
#include "controller/prediction/motion_model.h"
#include "controller/prediction/predictor.h"
#include "tests/controller/test_signal.h"

namespace gauntlet::controller {
namespace {

using Real = long double;
constexpr double kRateHz = 1000.0;
constexpr int kSamples = 20000;
constexpr int kHorizon = 100;

double WorstError(const PredictionConfig& config, const std::function<Real(double)>& reference) {
  const auto predictor = MakePredictor(config, 1, kRateHz);
  const TestSignal input = 0.003 * GloveCounts(kSamples, 1);
  double worst = 0.0;
  for (int k = 0; k < kSamples; ++k) {
    double output = 0.0;
    predictor->Step(RowOf(input, k), {&output, 1});
    const Real expected = reference(input(k, 0));
    worst = std::max(worst, static_cast<double>(std::abs((output - expected) / expected)));
  }
  return worst;
}

/// A filter at rest at its first sample, then x = A x + K (z - H A x).
struct RealFilter {
  Eigen::Matrix<Real, 3, 3> a;
  Eigen::Matrix<Real, 3, 1> k;
  Eigen::Matrix<Real, 1, 3> h, ahead;
  Eigen::Matrix<Real, 3, 1> x = Eigen::Matrix<Real, 3, 1>::Zero();

  Real Step(Real z) {
    const Eigen::Matrix<Real, 3, 1> prior = a * x;
    x = prior + k * (z - (h * prior)(0));
    return (ahead * x)(0);
  }
};

TEST(PredictionExactness, KalmanOfThreeStates) {
  const KalmanSteadyConfig model = {
      .noise = {.r = {0.5}, .q = {1e6}, .process_noise = ProcessNoise::kWhite}, .states = 3};
  RealFilter filter;
  filter.a << 1, 1, 0.5L, 0, 1, 1, 0, 0, 1;
  filter.k = SteadyGains(model, 1, kRateHz).matrix().transpose().cast<Real>();
  filter.h << 1, 0, 0;
  filter.ahead << 1, kHorizon, Real{0.5L} * kHorizon * kHorizon;
  bool first = true;
  EXPECT_LE(WorstError({KalmanPredictionConfig{.horizon_ms = {kHorizon}, .states = 3}},
                       [&](double z) {
                         if (first) filter.x[0] = z;
                         first = false;
                         return filter.Step(z);
                       }),
            1e-12);
}

TEST(PredictionExactness, Fitted) {
  FittedPredictionConfig config{.order = 40, .tap_ms = 5.0, .weights = {}};
  TestNoise noise(4);
  for (int i = 0; i < config.order; ++i) config.weights.push_back(noise.Normal() / 10.0);
  std::deque<double> past;
  EXPECT_LE(WorstError({config},
                       [&](double z) {
                         if (past.empty()) past.assign(201, z);
                         past.push_front(z);
                         past.pop_back();
                         Real sum = z;
                         for (std::size_t i = 1; i <= 40; ++i) {
                           sum += Real{config.weights[i - 1]} * (Real{past[5 * i]} - z);
                         }
                         return sum;
                       }),
            1e-12);
}

/// Three channels, each with weights of its own taps and of where all are and how they move.
TEST(PredictionExactness, FittedToAllChannels) {
  constexpr int kOrder = 7, kTap = 4, kChannels = 3;
  FittedPredictionConfig config{.order = kOrder, .tap_ms = kTap, .tap_means = true, .weights = {}};
  TestNoise noise(4);
  const auto fill = [&](std::vector<double>& values, int count) {
    for (int i = 0; i < count; ++i) values.push_back(noise.Normal() / 10.0);
  };
  fill(config.weights, kOrder * kChannels);
  fill(config.position_weights, kChannels * kChannels);
  fill(config.slope_weights, kChannels * kChannels);
  fill(config.offset_deg, kChannels);
  const auto predictor = MakePredictor({config}, kChannels, kRateHz);
  const TestSignal input = 0.003 * GloveCounts(2000, kChannels);
  const auto at = [&](int k, int c) { return Real{input(std::max(k, 0), c)}; };
  const auto mean = [&](int k, int c, int tap) {
    Real sum = 0;
    for (int i = 0; i < kTap; ++i) sum += at(k - tap * kTap + i, c);
    return sum / kTap;
  };
  double worst = 0.0;
  for (int k = 0; k < input.rows(); ++k) {
    std::vector<double> output(kChannels);
    predictor->Step(RowOf(input, k), output);
    for (int c = 0; c < kChannels; ++c) {
      Real expected = at(k, c) + Real{config.offset_deg[c]} * std::numbers::pi_v<Real> / 180;
      for (int i = 1; i <= kOrder; ++i) {
        expected += config.weights[c * kOrder + i - 1] * (mean(k, c, i) - at(k, c));
      }
      for (int d = 0; d < kChannels; ++d) {
        expected += config.position_weights[c * kChannels + d] * mean(k, d, 1);
        expected += config.slope_weights[c * kChannels + d] * (mean(k, d, 1) - mean(k, d, 6));
      }
      worst = std::max(worst, static_cast<double>(std::abs((output[c] - expected) / expected)));
    }
  }
  EXPECT_LE(worst, 1e-12);
}

/// Two predictors that have tests of their own, mixed as the header of the fallback says.
TEST(PredictionExactness, Fallback) {
  const AdaptivePredictionConfig general = {.horizon_ms = {kHorizon}, .r_deg2 = {0.8}};
  FittedPredictionConfig config{.horizon_ms = {kHorizon}, .order = 2, .tap_ms = 40.0};
  config.weights = {-1.5, 0.4};
  config.r_deg2 = general.r_deg2;
  config.fallback = false;
  const auto fitted = MakePredictor(config, 1, kRateHz);
  const auto adaptive = MakePredictor(general, 1, kRateHz);
  config.fallback = true;
  const Real degrees = 180 / std::numbers::pi_v<Real>;
  std::deque<std::array<double, 2>> expected;
  std::array<Real, 2> miss = {1, 1};
  const auto reference = [&](double z) -> Real {
    std::array<double, 2> next{};
    fitted->Step({&z, 1}, {&next[0], 1});
    adaptive->Step({&z, 1}, {&next[1], 1});
    if (expected.empty()) {
      expected.assign(kHorizon, {z, z});
      return z;
    }
    std::array<Real, 2> share{};
    for (std::size_t m = 0; m < 2; ++m) {
      const Real off = degrees * (Real{z} - Real{expected.back()[m]});
      const Real square = std::clamp(off * off / Real{0.8L}, Real{1e-2L}, Real{1e4L});
      miss[m] -= std::expm1(-1 / Real{1000}) * (square - miss[m]);
      share[m] = 1 / (miss[m] * miss[m] * miss[m]);
    }
    expected.push_front(next);
    expected.pop_back();
    return (share[0] * next[0] + share[1] * next[1]) / (share[0] + share[1]);
  };
  EXPECT_LE(WorstError({config}, reference), 1e-12);
}

/// The bank as its header says; gains are those of Settle(), which has tests of its own.
TEST(PredictionExactness, Adaptive) {
  constexpr Real kMemory = 1000;
  const MotionModel models[] = {WhiteAcceleration(1e3),       WhiteJerk(1e6),
                                Swing(0.5, 0.03, 1e6, 10.0),  Swing(1.0, 0.03, 1e6, 10.0),
                                Swing(2.0, 0.03, 1e6, 100.0), Swing(3.0, 0.03, 1e5, 300.0)};
  const Real degrees = 180 / std::numbers::pi_v<Real>;
  std::vector<RealFilter> bank;
  for (const MotionModel& model : models) {
    const SettledFilter settled = Settle(model, 0.4, 1.0 / kRateHz);
    bank.push_back({settled.a.cast<Real>(), settled.k.cast<Real>(), model.h.cast<Real>(),
                    LookAhead(model, bank.empty() ? 0.0 : 1e-3 * kHorizon).cast<Real>()});
  }
  std::array<std::deque<Real>, 6> expected;
  std::array<Real, 6> miss;
  miss.fill(1);
  bool first = true;
  EXPECT_LE(WorstError({AdaptivePredictionConfig{.horizon_ms = {kHorizon}, .r_deg2 = {0.4}}},
                       [&](double z) -> Real {
                         if (first) {
                           for (int m = 0; m < 6; ++m) {
                             bank[m].x[0] = z;
                             expected[m].assign(kHorizon, z);
                           }
                           first = false;
                           return z;
                         }
                         Real sum = 0, shares = 0;
                         for (int m = 0; m < 6; ++m) {
                           const Real off = (z - expected[m].front()) * degrees;
                           const Real square = std::clamp<Real>(off * off / 0.4, 0.01L, 1e4L);
                           const Real keep = std::exp(-1 / kMemory);
                           miss[m] = keep * miss[m] + (1 - keep) * square;
                           const Real y = bank[m].Step(z);
                           expected[m].pop_front();
                           expected[m].push_back(y);
                           sum += y / std::pow(miss[m], Real{3});
                           shares += 1 / std::pow(miss[m], Real{3});
                         }
                         return sum / shares;
                       }),
            1e-12);
}

}  // namespace
}  // namespace gauntlet::controller
