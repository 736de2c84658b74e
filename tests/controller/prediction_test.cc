#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string_view>
#include <vector>

#include "controller/prediction/predictor.h"
#include "tests/controller/test_signal.h"

namespace gauntlet::controller {
namespace {

constexpr double kRateHz = 1000.0;
constexpr int kHorizon = 60;

double RmsError(const PredictionConfig& config, double frequency_hz, double noise_deg) {
  const auto predictor = MakePredictor(config, 1, kRateHz);
  TestNoise noise(21);
  const auto truth = [frequency_hz](int k) {
    return 45.0 * std::sin(2.0 * std::numbers::pi * frequency_hz * k / kRateHz);
  };
  double sum = 0.0;
  int count = 0;
  for (int k = 0; k < 8000; ++k) {
    double value = truth(k) + noise_deg * noise.Normal();
    if (predictor) predictor->Step({&value, 1}, {&value, 1});
    if (k < 2000) continue;
    const double error = value - truth(k + kHorizon);
    sum += error * error;
    ++count;
  }
  return std::sqrt(sum / count);
}

constexpr PredictionConfig kLinear = {
    LinearPredictionConfig{.horizon_ms = kHorizon, .window_ms = 60.0}};
constexpr PredictionConfig kKalman = {KalmanPredictionConfig{.horizon_ms = kHorizon}};

TEST(Predictor, LooksAheadExactlyOnAStraightLine) {
  for (const PredictionConfig& config : {kLinear, kKalman}) {
    const auto predictor = MakePredictor(config, 1, kRateHz);
    double output = 0.0;
    for (int k = 0; k < 5000; ++k) {
      const double input = 0.003 * k;
      predictor->Step({&input, 1}, {&output, 1});
    }
    EXPECT_NEAR(output, 0.003 * (4999 + kHorizon), 1e-9);
  }
}

TEST(Predictor, KeepsAConstant) {
  for (const PredictionConfig& config : {kLinear, kKalman}) {
    const auto predictor = MakePredictor(config, 3, kRateHz);
    const std::vector<double> input = {0.1, -2.0, 1.3};
    std::vector<double> output(3);
    for (int k = 0; k < 200; ++k) {
      predictor->Step(input, output);
      for (int i = 0; i < 3; ++i) EXPECT_NEAR(output[i], input[i], 1e-12);
    }
  }
}

/// Noise-free, a line ahead of a sine of frequency f errs like |exp(j a) - 1 - j a|, a = 2 pi f h,
/// against |exp(j a) - 1| of no prediction: it pays below f h = 0.3.
TEST(Predictor, PaysForSlowMotionAndNotForFast) {
  const PredictionConfig none = {};
  for (const PredictionConfig& config : {kLinear, kKalman}) {
    EXPECT_LT(RmsError(config, 0.5, 0.5), 0.6 * RmsError(none, 0.5, 0.5));
    EXPECT_LT(RmsError(config, 1.0, 0.5), 0.9 * RmsError(none, 1.0, 0.5));
    EXPECT_GT(RmsError(config, 6.0, 0.5), RmsError(none, 6.0, 0.5));
  }
}

TEST(Predictor, RaisesNoise) {
  const auto predictor = MakePredictor(kKalman, 1, kRateHz);
  const auto follower = MakePredictor(KalmanPredictionConfig{.horizon_ms = 0.0}, 1, kRateHz);
  TestNoise noise(3);
  double ahead = 0.0;
  double now = 0.0;
  for (int k = 0; k < 20000; ++k) {
    const double input = noise.Normal();
    double output = 0.0;
    predictor->Step({&input, 1}, {&output, 1});
    ahead += output * output;
    follower->Step({&input, 1}, {&output, 1});
    now += output * output;
  }
  EXPECT_GT(ahead, 1.5 * now);
}

TEST(Predictor, StartsAgainAfterResetAndKeepsChannelsApart) {
  for (const PredictionConfig& config : {kLinear, kKalman}) {
    const auto used = MakePredictor(config, 2, kRateHz);
    const auto fresh = MakePredictor(config, 2, kRateHz);
    const TestSignal input = GloveCounts(300, 2);
    std::vector<double> output(2), expected(2);
    for (int k = 0; k < 300; ++k) used->Step(RowOf(input, k), output);
    used->ResetChannel(0);
    used->ResetChannel(1);
    for (int k = 0; k < 300; ++k) {
      used->Step(RowOf(input, k), output);
      fresh->Step(RowOf(input, k), expected);
      ASSERT_EQ(output, expected);
    }
  }
}

TEST(Predictor, RefusesAWindowWithoutASlope) {
  EXPECT_THROW(MakePredictor(LinearPredictionConfig{.window_ms = 20.0}, 1, 50.0), SettingError);
}

TEST(PredictionKinds, ExplainThemselves) {
  std::vector<std::string_view> names;
  for (const PredictionKind& kind : PredictionKinds()) {
    EXPECT_FALSE(kind.summary.empty()) << kind.name;
    EXPECT_EQ(kind.defaults.kind(), kind.name);
    names.push_back(kind.name);
  }
  EXPECT_EQ(names, (std::vector<std::string_view>{"none", "linear", "kalman"}));
}

}  // namespace
}  // namespace gauntlet::controller
