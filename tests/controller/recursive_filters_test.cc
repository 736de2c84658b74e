// Filters whose memory is a few numbers per channel, each against its definition.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>
#include <complex>
#include <numbers>

#include "controller/filters/filter_registry.h"
#include "tests/controller/test_signal.h"

namespace gauntlet::controller {
namespace {

using Real = long double;
constexpr double kRateHz = 1000.0;
constexpr double kPi = std::numbers::pi;

double StepOne(Filter& filter, double input) {
  double output = 0.0;
  filter.Step({&input, 1}, {&output, 1});
  return output;
}

/// Gain at a frequency: the projection of the settled answer to a sine on sine and cosine.
double GainAt(Filter& filter, double frequency_hz, int settling_periods) {
  const int period = static_cast<int>(std::lround(kRateHz / frequency_hz));
  std::complex<double> sum = 0.0;
  for (int k = 0; k < (settling_periods + 1) * period; ++k) {
    const double phase = 2.0 * kPi * k / period;
    const double output = StepOne(filter, std::sin(phase));
    if (k >= settling_periods * period) sum += output * std::polar(1.0, -phase);
  }
  return std::abs(sum) * 2.0 / period;
}

TEST(ExponentialFilter, AnswersAStepAsTheGeometricSeries) {
  const auto filter = MakeFilter(ExponentialConfig{.alpha = 0.2}, 1, kRateHz);
  StepOne(*filter, 0.0);
  for (int k = 1; k < 60; ++k) {
    EXPECT_NEAR(StepOne(*filter, 1.0), 1.0 - std::pow(0.8, k), 1e-14);
  }
}

/// The published algorithm with its two low-pass objects, in long double.
class ReferenceOneEuro {
 public:
  ReferenceOneEuro(Real rate, const OneEuroConfig& config)
      : rate_(rate),
        min_cutoff_(config.min_cutoff_hz),
        beta_(config.beta),
        derivative_cutoff_(config.derivative_cutoff_hz),
        from_raw_(config.speed_from == OneEuroConfig::SpeedFrom::kRaw) {}

  Real operator()(Real x) {
    const Real from = from_raw_ ? last_ : position_.value;
    const Real derivative = position_.started ? (x - from) * rate_ : 0;
    last_ = x;
    const Real smooth_derivative = speed_(derivative, Alpha(derivative_cutoff_));
    return position_(x, Alpha(min_cutoff_ + beta_ * std::abs(smooth_derivative)));
  }

 private:
  struct LowPass {
    bool started = false;
    Real value = 0;
    Real operator()(Real x, Real alpha) {
      value = started ? alpha * x + (1 - alpha) * value : x;
      started = true;
      return value;
    }
  };
  Real Alpha(Real cutoff) const {
    const Real tau = 1 / (2 * std::numbers::pi_v<Real> * cutoff);
    return 1 / (1 + tau * rate_);
  }

  Real rate_, min_cutoff_, beta_, derivative_cutoff_;
  bool from_raw_;
  Real last_ = 0;
  LowPass position_, speed_;
};

/// Largest relative difference from the reference.
double DifferenceFromReference(const OneEuroConfig& config) {
  const auto filter = MakeFilter(config, 1, kRateHz);
  ReferenceOneEuro reference(1000, config);
  const TestSignal input = GloveCounts(94096, 1);
  double worst = 0.0;
  for (int k = 0; k < input.rows(); ++k) {
    const Real expected = reference(input(k, 0));
    worst =
        std::max<double>(worst, std::abs((StepOne(*filter, input(k, 0)) - expected) / expected));
  }
  return worst;
}

TEST(OneEuroFilter, FollowsThePublishedAlgorithm) {
  EXPECT_LE(
      DifferenceFromReference({.min_cutoff_hz = 1.3, .beta = 0.004, .derivative_cutoff_hz = 2.0}),
      1e-12);
}

/// As MediaPipe has it. Wrong: the speed from the last filtered value.
TEST(OneEuroFilter, TakesItsSpeedFromTheLastSampleIfAsked) {
  EXPECT_LE(DifferenceFromReference({.min_cutoff_hz = 1.3,
                                     .beta = 0.004,
                                     .derivative_cutoff_hz = 2.0,
                                     .speed_from = OneEuroConfig::SpeedFrom::kRaw}),
            1e-12);
}

TEST(OneEuroFilter, OpensWhenTheSignalMoves) {
  const auto slow = MakeFilter(OneEuroConfig{.beta = 0.0}, 1, kRateHz);
  const auto fast = MakeFilter(OneEuroConfig{.beta = 0.05}, 1, kRateHz);
  double lag_slow = 0.0;
  double lag_fast = 0.0;
  for (int k = 0; k < 1000; ++k) {
    lag_slow = k - StepOne(*slow, k);
    lag_fast = k - StepOne(*fast, k);
  }
  EXPECT_LT(lag_fast, 0.2 * lag_slow);
}

TEST(ButterworthFilter, LosesThreeDecibelsAtItsCutoff) {
  for (int order = 1; order <= 8; ++order) {
    for (const double cutoff_hz : {5.0, 50.0}) {
      const ButterworthConfig config{.order = order, .cutoff_hz = cutoff_hz};
      const auto filter = MakeFilter(config, 1, kRateHz);
      // The gain falls by order / 2 times the frequency's share: within 0.1 % of the cutoff.
      EXPECT_NEAR(GainAt(*filter, cutoff_hz, 40) / std::sqrt(0.5), 1.0, 5e-4) << order;
    }
  }
}

TEST(ButterworthFilter, HasTheGainOfItsDefinition) {
  for (const int order : {1, 2, 5, 8}) {
    for (const double frequency_hz : {4.0, 20.0, 25.0, 100.0}) {
      const auto filter =
          MakeFilter(ButterworthConfig{.order = order, .cutoff_hz = 20.0}, 1, kRateHz);
      const double ratio = std::tan(kPi * frequency_hz / kRateHz) / std::tan(kPi * 20.0 / kRateHz);
      const double expected = 1.0 / std::sqrt(1.0 + std::pow(ratio, 2 * order));
      EXPECT_NEAR(GainAt(*filter, frequency_hz, 60), expected, 1e-6) << order << frequency_hz;
    }
  }
}

TEST(ButterworthFilter, RefusesACutoffAboveHalfTheRate) {
  EXPECT_THROW(MakeFilter(ButterworthConfig{.cutoff_hz = 500.0}, 1, kRateHz), SettingError);
  EXPECT_THROW(MakeFilter({ButterworthConfig{.order = 9}}, 1, kRateHz), SettingError);
}

/// Largest pole of (I - K H) A, which decides whether gains are stable: how a power of it grows, to
/// the 2^40th.
/// Eigen's eigenvalues take seconds to compile.
double LargestPole(const Eigen::VectorXd& gain) {
  const Eigen::Index n = gain.size();
  Eigen::Matrix3d a;
  a << 1.0, 1.0, 0.5, 0.0, 1.0, 1.0, 0.0, 0.0, 1.0;
  Eigen::Matrix3d power = Eigen::Matrix3d::Zero();
  for (Eigen::Index i = 0; i < n; ++i) {
    for (Eigen::Index j = 0; j < n; ++j) power(i, j) = a(i, j) - gain[i] * a(0, j);
  }
  double log_growth = 0.0;
  for (int k = 0; k <= 40; ++k) {
    const double norm = power.norm();
    log_growth += std::ldexp(std::log(norm), -k);
    power /= norm;
    power = (power * power).eval();
  }
  return std::exp(log_growth);
}

bool IsAccepted(const FilterConfig& config) {
  try {
    MakeFilter(config, 1, kRateHz);
  } catch (const SettingError&) {
    return false;
  }
  return true;
}

TEST(AlphaBetaFilter, AcceptsExactlyTheStableGains) {
  TestNoise noise(11);
  int accepted = 0;
  for (int trial = 0; trial < 2000; ++trial) {
    const double alpha = 2.0 * noise.Uniform();
    const double beta = 4.0 * noise.Uniform();
    const double gamma = 2.0 * alpha * beta / (2.0 - alpha) * noise.Uniform();
    const bool two = IsAccepted({AlphaBetaConfig{.alpha = alpha, .beta = beta}});
    EXPECT_EQ(two, LargestPole(Eigen::Vector2d(alpha, beta)) < 1.0) << alpha << " " << beta;
    if (gamma >= 8.0) continue;
    const bool three =
        IsAccepted({AlphaBetaGammaConfig{.alpha = alpha, .beta = beta, .gamma = gamma}});
    EXPECT_EQ(three, LargestPole(Eigen::Vector3d(alpha, beta, 2.0 * gamma)) < 1.0)
        << alpha << " " << beta << " " << gamma;
    accepted += two + three;
  }
  EXPECT_GT(accepted, 500);
}

TEST(AlphaBetaFilter, FollowsARampWithoutLag) {
  const auto filter = MakeFilter(AlphaBetaConfig{}, 1, kRateHz);
  double output = 0.0;
  for (int k = 0; k < 2000; ++k) output = StepOne(*filter, 3.0 * k);
  EXPECT_NEAR(output, 3.0 * 1999, 1e-8);
}

TEST(AlphaBetaGammaFilter, FollowsAParabolaWithoutLag) {
  const auto filter = MakeFilter(AlphaBetaGammaConfig{}, 1, kRateHz);
  double output = 0.0;
  for (int k = 0; k < 2000; ++k) output = StepOne(*filter, 0.01 * k * k);
  EXPECT_NEAR(output, 0.01 * 1999 * 1999, 1e-6);
}

TEST(AlphaBetaGammaFilter, HasItsDefaultPolesAtTheNamedPlace) {
  const AlphaBetaGammaConfig config;
  EXPECT_NEAR(LargestPole(Eigen::Vector3d(config.alpha, config.beta, 2.0 * config.gamma)), 0.95,
              1e-4);  // a triple pole moves by the cube root of rounding
}

}  // namespace
}  // namespace gauntlet::controller
