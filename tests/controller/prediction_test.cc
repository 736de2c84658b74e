#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <string>
#include <string_view>
#include <vector>

#include "controller/controller.h"
#include "controller/filters/steady_gains.h"
#include "controller/prediction/motion_model.h"
#include "controller/prediction/motion_path.h"
#include "controller/prediction/predictor.h"
#include "tests/controller/allocation_counter.h"
#include "tests/controller/test_hand.h"
#include "tests/controller/test_signal.h"

namespace gauntlet::controller {
namespace {

constexpr double kRateHz = 1000.0;
constexpr int kHorizon = 60;
constexpr int kChannels = 18;
constexpr double kPi = std::numbers::pi;

struct PredictionCase {
  std::string name;
  PredictionConfig config;
};
void PrintTo(const PredictionCase& tested, std::ostream* out) { *out << tested.name; }

/// Weights that go along the line through the newest sample and the oldest: 20 taps of 5 ms.
FittedPredictionConfig AlongALine() {
  FittedPredictionConfig fitted{.order = 20, .tap_ms = 5.0, .weights = std::vector<double>(20)};
  fitted.weights.back() = -kHorizon / 100.0;
  return fitted;
}

/// Every kind but `none`, and settings that take another way through the code.
std::vector<PredictionCase> PredictionCases() {
  const std::vector<double> horizon_ms = {kHorizon};
  std::vector<double> horizons_ms;
  std::vector<double> variances_deg2;
  for (int i = 0; i < kChannels; ++i) {
    horizons_ms.push_back(5.0 * i);
    variances_deg2.push_back(0.1 + 0.05 * i);
  }
  FittedPredictionConfig each = AlongALine();
  for (int i = 1; i < kChannels; ++i) {
    each.weights.insert(each.weights.end(), each.weights.begin(), each.weights.begin() + 20);
    each.weights.back() *= 0.9;
  }
  FittedPredictionConfig means = each;
  means.tap_means = true;
  FittedPredictionConfig fallback = AlongALine();
  fallback.horizon_ms = horizon_ms;
  FittedPredictionConfig fallback_each = means;
  fallback_each.horizon_ms = horizons_ms;
  fallback_each.r_deg2 = variances_deg2;
  return {
      {"linear", {LinearPredictionConfig{.horizon_ms = horizon_ms}}},
      {"linear_each", {LinearPredictionConfig{.horizon_ms = horizons_ms}}},
      {"kalman", {KalmanPredictionConfig{.horizon_ms = horizon_ms}}},
      {"kalman_three_states", {KalmanPredictionConfig{.horizon_ms = horizon_ms, .states = 3}}},
      {"kalman_each",
       {KalmanPredictionConfig{.horizon_ms = horizons_ms, .states = 3, .r_deg2 = variances_deg2}}},
      {"adaptive", {AdaptivePredictionConfig{.horizon_ms = horizon_ms}}},
      {"adaptive_each",
       {AdaptivePredictionConfig{.horizon_ms = horizons_ms, .r_deg2 = variances_deg2}}},
      {"fitted", {AlongALine()}},
      {"fitted_each", {each}},
      {"fitted_means", {means}},
      {"fitted_fallback", {fallback}},
      {"fitted_fallback_each", {fallback_each}}};
}

/// The same and slopes of all channels: predictions that look at other channels, too.
std::vector<PredictionCase> CoupledCases() {
  FittedPredictionConfig fitted = AlongALine();
  fitted.tap_means = true;
  for (int i = 0; i < kChannels * kChannels; ++i) {
    fitted.slope_weights.push_back(0.1 * std::cos(2.0 * i));
  }
  return {{"fitted_slopes", {fitted}}};
}
std::vector<PredictionCase> AllCases() {
  std::vector<PredictionCase> cases = PredictionCases();
  for (const PredictionCase& coupled : CoupledCases()) cases.push_back(coupled);
  return cases;
}

/// Of one channel: settings with a value, or so many values, per channel keep only that channel's.
PredictionConfig ForOneChannel(PredictionConfig config, int channel) {
  const auto pick = [channel](std::vector<double>& values) {
    const std::size_t each = values.size() / kChannels;
    if (each == 0 || values.size() % kChannels != 0) return;
    values = {values.begin() + std::ptrdiff_t(each) * channel,
              values.begin() + std::ptrdiff_t(each) * (channel + 1)};
  };
  std::visit(
      [&](auto& settings) {
        if constexpr (requires { settings.horizon_ms; }) pick(settings.horizon_ms);
        if constexpr (requires { settings.r_deg2; }) pick(settings.r_deg2);
        if constexpr (requires { settings.weights; }) pick(settings.weights);
      },
      config.settings);
  return config;
}

/// Angles [rad] of a moving glove.
TestSignal GloveAngles(int samples, int channels, std::uint64_t seed = 1) {
  return 0.003 * GloveCounts(samples, channels, seed);
}

TestSignal Predicted(Filter& predictor, const TestSignal& input) {
  TestSignal output(input.rows(), input.cols());
  for (Eigen::Index k = 0; k < input.rows(); ++k) {
    predictor.Step(RowOf(input, k), RowOf(output, k));
  }
  return output;
}

class PredictorProperties : public testing::TestWithParam<PredictionCase> {
 protected:
  std::unique_ptr<Filter> Make() const {
    return MakePredictor(GetParam().config, kChannels, kRateHz);
  }
};

/// Of predictions that look at no other channel.
class SeparateChannels : public PredictorProperties {};

TEST_P(PredictorProperties, KeepsAConstant) {
  TestSignal input(500, kChannels);
  for (int i = 0; i < kChannels; ++i) input.col(i).setConstant(-1.0 + 0.13 * i);
  EXPECT_LE((Predicted(*Make(), input) - input).cwiseAbs().maxCoeff(), 1e-12);
}

TEST_P(PredictorProperties, StartsAgainAfterReset) {
  const auto used = Make();
  Predicted(*used, GloveAngles(300, kChannels, 1));
  used->Reset();
  const TestSignal input = GloveAngles(300, kChannels, 2);
  EXPECT_EQ(Predicted(*used, input), Predicted(*Make(), input));
}

TEST_P(SeparateChannels, KeepsChannelsApartBitForBit) {
  const TestSignal input = GloveAngles(400, kChannels);
  TestSignal disturbed = input;
  constexpr int kQuiet = 7;
  for (int i = 0; i < kChannels; ++i) {
    if (i != kQuiet) disturbed.col(i) = disturbed.col(i) * -1.7 + TestSignal::Ones(400, 1) * 0.3;
  }
  EXPECT_EQ(Predicted(*Make(), input).col(kQuiet), Predicted(*Make(), disturbed).col(kQuiet));
}

TEST_P(SeparateChannels, GivesTheSameBitsForOneChannelAsForMany) {
  const TestSignal input = GloveAngles(400, kChannels);
  const TestSignal together = Predicted(*Make(), input);
  for (const int channel : {0, 3, 17}) {
    const auto alone = MakePredictor(ForOneChannel(GetParam().config, channel), 1, kRateHz);
    EXPECT_EQ(Predicted(*alone, input.col(channel)).col(0), together.col(channel)) << channel;
  }
}

TEST_P(SeparateChannels, ResetsOneChannelAndLeavesTheOthers) {
  const TestSignal before = GloveAngles(300, kChannels, 1);
  const TestSignal after = GloveAngles(300, kChannels, 2);
  const auto predictor = Make();
  const auto untouched = Make();
  Predicted(*predictor, before);
  Predicted(*untouched, before);
  constexpr int kChannel = 4;
  predictor->ResetChannel(kChannel);
  TestSignal expected = Predicted(*untouched, after);
  expected.col(kChannel) = Predicted(*Make(), after).col(kChannel);
  EXPECT_EQ(Predicted(*predictor, after), expected);
}

TEST_P(PredictorProperties, TakesMemoryWithoutAChangedBit) {
  const TestSignal before = GloveAngles(333, kChannels, 1);
  const TestSignal after = GloveAngles(300, kChannels, 2);
  const auto predictor = Make();
  const auto untouched = Make();
  Predicted(*predictor, before);
  Predicted(*untouched, before);
  const auto successor = Make();
  Predicted(*successor, GloveAngles(7, kChannels, 3));  // so that its clock stands elsewhere
  ASSERT_TRUE(successor->SwapMemory(*predictor));
  EXPECT_EQ(Predicted(*successor, after), Predicted(*untouched, after));
}

TEST_P(PredictorProperties, StartsWhereItIsTold) {
  TestSignal still(1, kChannels);
  for (int i = 0; i < kChannels; ++i) still(0, i) = -1.0 + 0.13 * i;
  const auto used = Make();
  Predicted(*used, GloveAngles(300, kChannels));
  used->StartAt(RowOf(still, 0));
  const auto fresh = Make();
  Predicted(*fresh, still);
  const TestSignal input = GloveAngles(300, kChannels, 2);
  EXPECT_EQ(Predicted(*used, input), Predicted(*fresh, input));
}

TEST_P(PredictorProperties, MayWriteOverItsInput) {
  const TestSignal input = GloveAngles(300, kChannels);
  const auto predictor = Make();
  TestSignal in_place = input;
  for (Eigen::Index k = 0; k < input.rows(); ++k) {
    predictor->Step(RowOf(in_place, k), RowOf(in_place, k));
  }
  EXPECT_EQ(in_place, Predicted(*Make(), input));
}

TEST_P(PredictorProperties, DoesNotAllocateInStepNorReset) {
  const TestSignal input = GloveAngles(200, kChannels);
  TestSignal output(input.rows(), input.cols());
  const auto predictor = Make();
  const auto other = Make();
  const long before = AllocationCount();
  for (Eigen::Index k = 0; k < input.rows(); ++k)
    predictor->Step(RowOf(input, k), RowOf(output, k));
  predictor->ResetChannel(3);
  predictor->SwapMemory(*other);
  predictor->StartAt(RowOf(input, 0));
  predictor->Reset();
  EXPECT_EQ(AllocationCount(), before);
}

TEST_P(PredictorProperties, StaysFiniteAndForgetsAnExtremeSample) {
  TestSignal input = GloveAngles(15000, kChannels);
  const TestSignal expected = Predicted(*Make(), input);
  input.row(50).setConstant(1e9);
  input.row(51).setConstant(-1e9);
  const TestSignal output = Predicted(*Make(), input);
  EXPECT_TRUE(output.allFinite());
  // One that learns may have learned otherwise, by a few degrees.
  EXPECT_LE((output - expected).bottomRows(10).cwiseAbs().maxCoeff(), 0.1);
}

TEST_P(PredictorProperties, StaysFiniteWhateverComes) {
  const auto predictor = Make();
  TestNoise noise(5);
  std::vector<double> values(kChannels);
  std::vector<double> output(kChannels);
  for (int k = 0; k < 5000; ++k) {
    for (double& value : values) {
      value = std::pow(10.0, 200.0 * noise.Uniform() - 190.0) * (noise.Uniform() < 0.5 ? 1 : -1);
    }
    predictor->Step(values, output);
    for (const double value : output) ASSERT_TRUE(std::isfinite(value)) << k;
  }
}

TEST_P(PredictorProperties, MakesNoSubnormalNumberOfADecayingInput) {
  const auto predictor = Make();
  std::vector<double> input(kChannels, 1.0);
  std::vector<double> output(kChannels);
  for (int k = 0; k < 20000; ++k) {
    for (double& value : input) value *= 0.95;  // subnormal itself in the end
    predictor->Step(input, output);
    ASSERT_NE(std::fpclassify(output[3]), FP_SUBNORMAL) << k;
  }
}

TEST_P(PredictorProperties, RefusesNoChannelsAndRatesThatAreNone) {
  const auto refuses = [&](int channels, double rate_hz) {
    EXPECT_THROW(MakePredictor(GetParam().config, channels, rate_hz), SettingError);
  };
  for (const int channels : {0, -1}) refuses(channels, kRateHz);
  for (const double rate_hz : {0.0, -1.0, HUGE_VAL, std::nan("")}) refuses(kChannels, rate_hz);
}

INSTANTIATE_TEST_SUITE_P(All, PredictorProperties, testing::ValuesIn(AllCases()),
                         [](const auto& tested) { return tested.param.name; });
INSTANTIATE_TEST_SUITE_P(All, SeparateChannels, testing::ValuesIn(PredictionCases()),
                         [](const auto& tested) { return tested.param.name; });

/// Row by row what a predictor of its own gives that looks so many events farther, bit for bit, and
/// through a channel that starts again and one that goes on where another path stood.
TEST(MotionPath, IsThePredictionSoManyEventsFartherAhead) {
  constexpr int kRows = 4;
  constexpr double kEvent_ms = 20.0;
  const TestSignal input = GloveAngles(900, kChannels);
  for (const PredictionCase& tested : PredictionCases()) {
    if (tested.name.starts_with("fitted")) continue;  // weights are for one horizon
    MotionPath path(tested.config, kChannels, kRateHz, kRows, kEvent_ms);
    MotionPath next(tested.config, kChannels, kRateHz, kRows, kEvent_ms);
    std::vector<std::unique_ptr<Filter>> expected;
    for (int row = 1; row < kRows; ++row) {
      PredictionConfig later = tested.config;
      std::visit(
          [&](auto& settings) {
            if constexpr (requires { settings.horizon_ms; }) {
              for (double& value : settings.horizon_ms) value += row * kEvent_ms;
            }
          },
          later.settings);
      expected.push_back(MakePredictor(later, kChannels, kRateHz));
    }
    std::vector<double> now(kChannels, 7.0), of_row(kChannels);
    for (int k = 0; k < input.rows(); ++k) {
      if (k == 300) path.ResetChannel(5);
      if (k == 600) next.SwapMemory(path, true, RowOf(input, k));
      MotionPath& stepped = k < 600 ? path : next;
      stepped.Step(RowOf(input, k), now);
      EXPECT_TRUE(std::ranges::equal(stepped.Row(0), now));
      for (int row = 1; row < kRows; ++row) {
        Filter& predictor = *expected[static_cast<std::size_t>(row - 1)];
        if (k == 300) predictor.ResetChannel(5);
        predictor.Step(RowOf(input, k), of_row);
        ASSERT_TRUE(std::ranges::equal(stepped.Row(row), of_row))
            << tested.name << ", row " << row << ", sample " << k;
      }
    }
  }
}

/// Of one channel, behind two seconds: what comes out against the truth `horizon` samples ahead.
template <class Truth>
double RmsError(const PredictionConfig& config, const Truth& truth, double noise_deg,
                int horizon = kHorizon) {
  const auto predictor = MakePredictor(config, 1, kRateHz);
  TestNoise noise(21);
  double sum = 0.0;
  int count = 0;
  for (int k = 0; k < 8000; ++k) {
    double value = (truth(k) + noise_deg * noise.Normal()) * kPi / 180.0;
    if (predictor) predictor->Step({&value, 1}, {&value, 1});
    if (k < 2000) continue;
    const double error = value * 180.0 / kPi - truth(k + horizon);
    sum += error * error;
    ++count;
  }
  return std::sqrt(sum / count);
}

auto Sine(double frequency_hz) {
  return [frequency_hz](int k) { return 45.0 * std::sin(2.0 * kPi * frequency_hz * k / kRateHz); };
}

const PredictionConfig kNone = {};
const PredictionConfig kLinear = {
    LinearPredictionConfig{.horizon_ms = {kHorizon}, .window_ms = 60.0}};
const PredictionConfig kKalman = {KalmanPredictionConfig{.horizon_ms = {kHorizon}}};
const PredictionConfig kParabola = {KalmanPredictionConfig{.horizon_ms = {kHorizon}, .states = 3}};

TEST(Predictor, LooksAheadExactlyOnAStraightLine) {
  for (const PredictionConfig& config :
       {kLinear, kKalman, kParabola, PredictionConfig{AlongALine()}}) {
    const auto predictor = MakePredictor(config, 1, kRateHz);
    double output = 0.0;
    for (int k = 0; k < 8000; ++k) {
      const double input = 0.003 * k;
      predictor->Step({&input, 1}, {&output, 1});
    }
    EXPECT_NEAR(output, 0.003 * (7999 + kHorizon), 1e-9) << config.kind();
  }
}

/// One that starts was always there, for all others; one that is held comes to rest for them.
TEST(FittedPrediction, OthersFeelNothingOfAChannelThatStartsNorLongOfOneThatIsHeld) {
  const PredictionConfig config = CoupledCases()[0].config;
  const auto predictor = MakePredictor(config, kChannels, kRateHz);
  const auto apart = MakePredictor(config, kChannels, kRateHz);
  constexpr int kFaulty = 7;
  const TestSignal input = GloveAngles(900, kChannels);
  TestSignal faulty = input;
  faulty.col(kFaulty).tail(600).setConstant(4.0);  // has jumped, and stays
  TestSignal still = input;
  still.col(kFaulty).setConstant(-2.0);
  TestSignal output = Predicted(*predictor, faulty.topRows(600));
  TestSignal expected = Predicted(*apart, still.topRows(600));
  output.col(kFaulty) = expected.col(kFaulty);
  EXPECT_GT((output - expected).middleRows(300, 100).cwiseAbs().maxCoeff(), 0.01);
  EXPECT_LE((output - expected).bottomRows(200).cwiseAbs().maxCoeff(), 1e-12);

  predictor->ResetChannel(kFaulty);
  faulty.col(kFaulty).tail(300).setConstant(9.0);
  output = Predicted(*predictor, faulty.bottomRows(300));
  expected = Predicted(*apart, still.bottomRows(300));
  output.col(kFaulty) = expected.col(kFaulty);
  EXPECT_LE((output - expected).cwiseAbs().maxCoeff(), 1e-12);
}

TEST(FittedPrediction, OthersSeeNothingOfAChannelThatIsOff) {
  ControllerConfig config;
  config.prediction = CoupledCases()[0].config;
  const auto commands = [&](double disturbance_counts, bool off) {
    Controller controller(config, PlainGlove(kChannels), CoupledHand(kChannels));
    const TestSignal counts = GloveCounts(600, kChannels);
    std::vector<double> angles;
    for (int k = 0; k < 600; ++k) {
      if (off && k == 300) controller.SetChannelActive(7, false);
      std::vector<double> sample(RowOf(counts, k).begin(), RowOf(counts, k).end());
      if (k >= 300) sample[7] += disturbance_counts * std::sin(0.05 * k);
      controller.Step({.counts = sample});
      for (std::size_t i = 0; i < kChannels; ++i) {
        if (i != 7) angles.push_back(controller.predicted_angle_rad()[i]);
      }
    }
    return angles;
  };
  EXPECT_NE(commands(0.0, false), commands(60.0, false));
  EXPECT_EQ(commands(0.0, true), commands(60.0, true));
}

TEST(FittedPrediction, GoesOnWithOtherWeights) {
  FittedPredictionConfig config =
      std::get<FittedPredictionConfig>(CoupledCases()[0].config.settings);
  const auto before = MakePredictor(config, kChannels, kRateHz);
  for (double& weight : config.slope_weights) weight *= -0.7;
  const auto next = MakePredictor(config, kChannels, kRateHz);
  const auto always = MakePredictor(config, kChannels, kRateHz);
  const TestSignal input = GloveAngles(500, kChannels);
  Predicted(*before, input.topRows(300));
  Predicted(*always, input.topRows(300));
  ASSERT_TRUE(next->SwapMemory(*before));
  EXPECT_EQ(Predicted(*next, input.bottomRows(200)), Predicted(*always, input.bottomRows(200)));
  config.tap_means = false;
  EXPECT_FALSE(MakePredictor(config, kChannels, kRateHz)->SwapMemory(*always));
}

TEST(KalmanPrediction, LooksAheadExactlyOnAParabolaWithThreeStates) {
  const auto predictor = MakePredictor(kParabola, 1, kRateHz);
  const auto parabola = [](double k) { return 1.0 - 0.002 * k + 3e-6 * k * k; };
  for (int k = 0; k < 5000; ++k) {
    double value = parabola(k);
    predictor->Step({&value, 1}, {&value, 1});
    if (k <= 4000) continue;
    ASSERT_NEAR(value, parabola(k + kHorizon), 1e-9) << k;
  }
}

/// A noise-free line ahead of a sine of frequency f errs like |exp(j a) - 1 - j a|, a = 2 pi f h,
/// against |exp(j a) - 1| of no prediction: it pays below f h = 0.3.
TEST(Predictor, PaysForSlowMotionAndNotForFast) {
  for (const PredictionConfig& config : {kLinear, kKalman}) {
    EXPECT_LT(RmsError(config, Sine(0.5), 0.5), 0.6 * RmsError(kNone, Sine(0.5), 0.5));
    EXPECT_LT(RmsError(config, Sine(1.0), 0.5), 0.9 * RmsError(kNone, Sine(1.0), 0.5));
    EXPECT_GT(RmsError(config, Sine(6.0), 0.5), RmsError(kNone, Sine(6.0), 0.5));
  }
}

/// At its settled gain K the filter is the transfer function C (z I - (I - K H) A)^-1 z K, with
/// A = [1 1 1/2; 0 1 1; 0 0 1] and C = [1 h h^2/2].
TEST(KalmanPrediction, ErrsOnASineAsItsTransferFunctionSays) {
  using Complex = std::complex<double>;
  const KalmanSteadyConfig model = {
      .noise = {.r = {0.5}, .q = {1e6}, .process_noise = ProcessNoise::kWhite}, .states = 3};
  const Eigen::Vector3d gain = SteadyGains(model, 1, kRateHz).matrix().transpose();
  Eigen::Matrix3d a;
  a << 1.0, 1.0, 0.5, 0.0, 1.0, 1.0, 0.0, 0.0, 1.0;
  const Eigen::RowVector3d h(1.0, 0.0, 0.0);
  const Eigen::RowVector3d c(1.0, kHorizon, 0.5 * kHorizon * kHorizon);
  const Eigen::Matrix3cd closed = ((Eigen::Matrix3d::Identity() - gain * h) * a).cast<Complex>();
  for (const double frequency_hz : {0.5, 1.0, 2.0, 3.0}) {
    const double w = 2.0 * kPi * frequency_hz / kRateHz;
    const Complex z = std::polar(1.0, w);
    const Eigen::Matrix3cd m = z * Eigen::Matrix3cd::Identity() - closed;
    const Complex response = z * (c.cast<Complex>() * m.inverse() * gain.cast<Complex>())(0);
    const double expected =
        45.0 / std::sqrt(2.0) * std::abs(response - std::polar(1.0, w * kHorizon));
    EXPECT_NEAR(RmsError(kParabola, Sine(frequency_hz), 0.0), expected, 0.01 * expected + 1e-6)
        << frequency_hz;
  }
}

TEST(Predictor, RaisesNoise) {
  const auto predictor = MakePredictor(kKalman, 1, kRateHz);
  const auto follower = MakePredictor(KalmanPredictionConfig{.horizon_ms = {0.0}}, 1, kRateHz);
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

/// Two ways to the same gain: Van Loan's matrix and the Riccati equation here, integrals by hand in
/// the steady Kalman filter.
TEST(MotionModel, HasTheGainOfTheSteadyKalmanFilter) {
  for (const double q : {1e3, 1e6}) {
    const KalmanSteadyConfig model = {
        .noise = {.r = {0.4}, .q = {q}, .process_noise = ProcessNoise::kWhite}, .states = 3};
    const Eigen::ArrayXXd expected = SteadyGains(model, 1, kRateHz);
    const SettledFilter filter = Settle(WhiteJerk(q), 0.4, 1.0 / kRateHz);
    for (int i = 0; i < 3; ++i) {
      EXPECT_NEAR(filter.k[i] * std::pow(1.0 / kRateHz, i), expected(0, i), 1e-9 * expected(0, i));
    }
  }
}

/// exp(F t) of an undamped swing is a rotation; of a line a line.
TEST(MotionModel, LooksAheadAsItsEquationSays) {
  const Eigen::RowVector3d swing = LookAhead(Swing(2.0, 0.0, 1.0, 1.0), 0.1);
  const double w = 4.0 * kPi;
  EXPECT_NEAR(swing[0], 1.0, 1e-14);
  EXPECT_NEAR(swing[1], std::cos(0.1 * w), 1e-14);
  EXPECT_NEAR(swing[2], std::sin(0.1 * w) / w, 1e-14);
  const Eigen::RowVector3d line = LookAhead(WhiteJerk(1.0), 0.3);
  EXPECT_NEAR(line[1], 0.3, 1e-15);
  EXPECT_NEAR(line[2], 0.045, 1e-15);
  EXPECT_EQ(LookAhead(Swing(2.0, 0.1, 1.0, 1.0), 0.0), Eigen::RowVector3d(1.0, 1.0, 0.0));
}

/// The servo's 100 ms: what the adaptive kind is for.
constexpr int kFar = 100;
AdaptivePredictionConfig Adaptive(double horizon_ms = kFar, double r_deg2 = 0.4) {
  return {.horizon_ms = {horizon_ms}, .r_deg2 = {r_deg2}};
}

TEST(AdaptivePrediction, TakesAwayMostOfTheDelayOfSlowAndFastSines) {
  for (const double frequency_hz : {0.25, 0.5, 1.0, 2.0, 3.0}) {
    EXPECT_LT(RmsError({Adaptive()}, Sine(frequency_hz), 0.65, kFar),
              0.4 * RmsError(kNone, Sine(frequency_hz), 0.65, kFar))
        << frequency_hz;
  }
}

TEST(AdaptivePrediction, IsBetterThanNoneWithAWrongModel) {
  for (const double wrong : {0.7, 1.3}) {
    for (const double frequency_hz : {0.5, 1.0, 2.0, 3.0}) {
      const double none = RmsError(kNone, Sine(frequency_hz), 0.65, kFar);
      EXPECT_LT(RmsError({Adaptive(kFar * wrong)}, Sine(frequency_hz), 0.65, kFar), none);
      EXPECT_LT(RmsError({Adaptive(kFar, 0.4 * wrong)}, Sine(frequency_hz), 0.65, kFar), none);
    }
  }
}

TEST(AdaptivePrediction, CalmsNoiseAtRest) {
  const auto still = [](int) { return 20.0; };
  EXPECT_LT(RmsError({Adaptive()}, still, 0.65, kFar), 0.5 * RmsError(kNone, still, 0.65, kFar));
}

/// Moves of 60 deg with the shape of least jerk, 0.6 s long, and a rest of 1 s at each end.
TEST(AdaptivePrediction, OvershootsByNoMoreThanATenthOfTheMovement) {
  const auto predictor = MakePredictor({Adaptive()}, 1, kRateHz);
  const auto truth = [](int k) {
    const int period = k % 3200;
    const double t = std::clamp((period % 1600 - 1000) / 600.0, 0.0, 1.0);
    const double way = 60.0 * t * t * t * (10.0 - 15.0 * t + 6.0 * t * t);
    return period < 1600 ? way : 60.0 - way;
  };
  double lowest = 0.0;
  double highest = 60.0;
  TestNoise noise(8);
  for (int k = 0; k < 16000; ++k) {
    double value = (truth(k) + 0.3 * noise.Normal()) * kPi / 180.0;
    predictor->Step({&value, 1}, {&value, 1});
    lowest = std::min(lowest, value * 180.0 / kPi);
    highest = std::max(highest, value * 180.0 / kPi);
  }
  EXPECT_GE(lowest, -6.0);
  EXPECT_LE(highest, 66.0);
}

/// Weights that foresee a sine of 1 Hz: z(k + h) = 2 cos(w h) z(k) - z(k - h).
FittedPredictionConfig ForASine(bool fallback) {
  const double w = 2.0 * kPi / kRateHz;
  FittedPredictionConfig fitted{.horizon_ms = {kFar}, .tap_ms = kFar, .fallback = fallback};
  fitted.weights = {1.0 - 2.0 * std::cos(w * kFar)};
  fitted.position_weights = {-1.0 - fitted.weights[0]};
  return fitted;
}

/// The weights serve the motion that they are for, the general prediction all others.
TEST(FittedPrediction, FallsBackOnMotionThatTheWeightsDoNotForesee) {
  const AdaptivePredictionConfig general = {.horizon_ms = {kFar}};
  const double own = RmsError({ForASine(false)}, Sine(1.0), 0.1, kFar);
  const double own_general = RmsError({general}, Sine(1.0), 0.1, kFar);
  ASSERT_LT(own, 0.7 * own_general);
  EXPECT_LT(RmsError({ForASine(true)}, Sine(1.0), 0.1, kFar), own + 0.35 * (own_general - own))
      << own << own_general;
  const double other = RmsError({ForASine(false)}, Sine(2.5), 0.1, kFar);
  const double other_general = RmsError({general}, Sine(2.5), 0.1, kFar);
  ASSERT_GT(other, 3.0 * other_general);
  EXPECT_LT(RmsError({ForASine(true)}, Sine(2.5), 0.1, kFar), 1.1 * other_general);
}

/// From a motion that the weights foresee to another: the output goes from their prediction to the
/// general one, stays between both and moves in each step hardly farther than they do. A switch
/// would jump by their difference, up to 1 rad.
TEST(FittedPrediction, HandsOverWithoutAJump) {
  const auto both = MakePredictor({ForASine(true)}, 1, kRateHz);
  const auto weights = MakePredictor({ForASine(false)}, 1, kRateHz);
  const auto general = MakePredictor(AdaptivePredictionConfig{.horizon_ms = {kFar}}, 1, kRateHz);
  double last_y = 0.0, last_f = 0.0, last_g = 0.0, worst = 0.0;
  double far_from_general = 0.0, far_from_weights = 0.0, phase = 0.0;
  for (int k = 0; k < 12000; ++k) {
    phase += 2.0 * kPi * (k < 6000 ? 1.0 : 2.5) / kRateHz;
    double z = 0.5 * std::sin(phase), y = 0.0, f = 0.0, g = 0.0;
    both->Step({&z, 1}, {&y, 1});
    weights->Step({&z, 1}, {&f, 1});
    general->Step({&z, 1}, {&g, 1});
    ASSERT_GE(y, std::min(f, g) - 1e-12);
    ASSERT_LE(y, std::max(f, g) + 1e-12);
    if (k > 300) {
      const double moved = std::max(std::abs(f - last_f), std::abs(g - last_g));
      worst = std::max(worst, std::abs(y - last_y) - moved);
    }
    if (4000 <= k && k < 6000) far_from_weights = std::max(far_from_weights, std::abs(y - f));
    if (k >= 10000) far_from_general = std::max(far_from_general, std::abs(y - g));
    last_y = y, last_f = f, last_g = g;
  }
  EXPECT_LT(worst, 0.02);
  EXPECT_LT(far_from_weights, 0.02);
  EXPECT_LT(far_from_general, 0.02);
}

TEST(Predictor, RefusesAWindowWithoutASlope) {
  EXPECT_THROW(MakePredictor(LinearPredictionConfig{.window_ms = 20.0}, 1, 50.0), SettingError);
}

TEST(Predictor, RefusesListsThatDoNotFit) {
  const auto complaint = [](const PredictionConfig& config) -> std::string {
    try {
      MakePredictor(config, 5, kRateHz);
      return "";
    } catch (const SettingError& error) {
      return error.what();
    }
  };
  EXPECT_EQ(complaint({AdaptivePredictionConfig{.horizon_ms = {1.0, 2.0}}}),
            "horizon_ms: has 2 values, must have 1 for all channels or 5, one for each");
  EXPECT_EQ(complaint({KalmanPredictionConfig{.r_deg2 = {1.0, 2.0}}}),
            "r_deg2: has 2 values, must have 1 for all channels or 5, one for each");
  EXPECT_EQ(complaint({FittedPredictionConfig{.order = 3, .weights = {1.0, 2.0}}}),
            "weights: has 2 values, must have 3 for all channels or 15, 3 for each");
  FittedPredictionConfig fitted = {.order = 3,
                                   .weights = {0.0, 0.0, 0.0},
                                   .position_weights = std::vector<double>(5),
                                   .slope_weights = std::vector<double>(25),
                                   .offset_deg = std::vector<double>(5)};
  EXPECT_EQ(complaint({fitted}), "");
  fitted.position_weights.resize(25);
  EXPECT_EQ(complaint({fitted}), "");
  fitted.position_weights.resize(6);
  EXPECT_EQ(complaint({fitted}),
            "position_weights: has 6 values, must have none, 5, one for each channel, or 25, one "
            "of every channel for each");
  fitted.position_weights.clear();
  fitted.slope_weights.resize(5);
  EXPECT_EQ(complaint({fitted}),
            "slope_weights: has 5 values, must have none or 25, one of every channel for each");
  fitted.slope_weights.clear();
  fitted.offset_deg.resize(1);
  EXPECT_EQ(complaint({fitted}), "offset_deg: has 1 values, must have none or 5");
  fitted.offset_deg.clear();
  fitted.horizon_ms = {1.0, 2.0};
  EXPECT_EQ(complaint({fitted}),
            "horizon_ms: has 2 values, must have 1 for all channels or 5, one for each");
  EXPECT_EQ(complaint({FittedToOthersPredictionConfig{}}),
            "kind: is fitted_to_others, which has no weights yet: gauntlet export and gauntlet "
            "calibrate --predictor fit them");
  EXPECT_EQ(complaint({FittedPredictionConfig{.order = 1, .tap_ms = 2.5, .weights = {1.0}}}),
            "tap_ms: is 2.5, must be a multiple of the step of the filter, 1 ms");
  EXPECT_THAT(complaint({AdaptivePredictionConfig{.horizon_ms = {-1.0}}}),
              testing::HasSubstr("horizon_ms"));
  EXPECT_THAT(complaint({AdaptivePredictionConfig{.horizon_ms = {1001.0}}}),
              testing::HasSubstr("horizon_ms"));
}

TEST(PredictionKinds, ExplainThemselves) {
  std::vector<std::string_view> names;
  for (const PredictionKind& kind : PredictionKinds()) {
    EXPECT_FALSE(kind.summary.empty()) << kind.name;
    EXPECT_EQ(kind.defaults.kind(), kind.name);
    names.push_back(kind.name);
  }
  EXPECT_EQ(names, (std::vector<std::string_view>{"none", "linear", "kalman", "adaptive", "fitted",
                                                  "fitted_to_others"}));
}

}  // namespace
}  // namespace gauntlet::controller
