#include "controller/filters/jerk_limit_filter.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "controller/filters/filter_registry.h"

namespace gauntlet::controller {
namespace {

constexpr double kRate_hz = 1000.0;
constexpr double kCounts = 1023.0;

std::vector<double> Follow(const JerkLimitConfig& config, const std::vector<double>& input) {
  const auto filter = MakeFilter(config, 1, kRate_hz);
  std::vector<double> output = input;
  for (double& value : output) filter->Step({&value, 1}, {&value, 1});
  return output;
}

class RandomLimits {
 public:
  JerkLimitConfig Next() {
    return {.max_velocity_per_s = std::exp(9.0 + 2.0 * Uniform()),
            .max_acceleration_per_s2 = std::exp(12.0 + 3.0 * Uniform()),
            .max_jerk_per_s3 = std::exp(16.0 + 4.0 * Uniform())};
  }
  double Uniform() { return uniform_(engine_); }

 private:
  std::mt19937_64 engine_{1};
  std::uniform_real_distribution<double> uniform_{-1.0, 1.0};
};

/// Noise over the whole range, a random walk, a square wave, a fast sine, a ramp, rest.
std::vector<double> HostileInput(RandomLimits& random) {
  std::vector<double> input;
  double walk = 500.0;
  for (int k = 0; k < 3000; ++k) {
    switch (k / 150 % 6) {
      case 0:
        input.push_back(kCounts * (0.5 + 0.5 * random.Uniform()));
        break;
      case 1:
        input.push_back(walk += 10.0 * random.Uniform());
        break;
      case 2:
        input.push_back(k % 50 < 25 ? 0.0 : kCounts);
        break;
      case 3:
        input.push_back(512.0 + 300.0 * std::sin(0.05 * k));
        break;
      case 4:
        input.push_back(5.0 * (k % 150));
        break;
      default:
        input.push_back(input.back());
    }
  }
  return input;
}

TEST(JerkLimit, KeepsAllLimitsWhateverTheInput) {
  RandomLimits random;
  constexpr double kRounding = 2e-12;  // 18 bits of 1023 counts, and three differences
  for (int trial = 0; trial < 60; ++trial) {
    const JerkLimitConfig config = random.Next();
    const std::vector<double> y = Follow(config, HostileInput(random));
    const double velocity = config.max_velocity_per_s / kRate_hz;
    const double acceleration = config.max_acceleration_per_s2 / (kRate_hz * kRate_hz);
    const double jerk = config.max_jerk_per_s3 / (kRate_hz * kRate_hz * kRate_hz);
    double most_jerk = 0.0;
    for (std::size_t k = 3; k < y.size(); ++k) {
      const double v[] = {y[k] - y[k - 1], y[k - 1] - y[k - 2], y[k - 2] - y[k - 3]};
      ASSERT_LE(std::abs(v[0]), velocity + kRounding) << trial << " " << k;
      ASSERT_LE(std::abs(v[0] - v[1]), acceleration + kRounding) << trial << " " << k;
      ASSERT_LE(std::abs(v[0] - 2.0 * v[1] + v[2]), jerk + kRounding) << trial << " " << k;
      most_jerk = std::max(most_jerk, std::abs(v[0] - 2.0 * v[1] + v[2]));
    }
    EXPECT_GT(most_jerk, 0.99 * std::min({jerk, acceleration, velocity})) << trial;  // it uses them
  }
}

/// Least time from rest to rest in continuous time [samples]: the textbook's seven phases.
/// Source: Biagiotti, Melchiorri, Trajectory Planning (2008), section 3.4.
double LeastSamples(const JerkLimitConfig& config, double way) {
  const double v_max = config.max_velocity_per_s;
  const double a_max = config.max_acceleration_per_s2;
  const double j_max = config.max_jerk_per_s3;
  const double a = std::min(a_max, std::sqrt(v_max * j_max));
  const double to_v_max = v_max / a + a / j_max;
  if (v_max * to_v_max <= way) return kRate_hz * (way / v_max + to_v_max);
  const double b = a_max * a_max / j_max;
  const double v = 0.5 * (std::sqrt(b * b + 4.0 * a_max * way) - b);
  if (v >= b) return kRate_hz * 2.0 * (v / a_max + a_max / j_max);
  return kRate_hz * 4.0 * std::cbrt(way / (2.0 * j_max));
}

TEST(JerkLimit, ReachesAConstantTargetInLeastTimeWithoutOvershoot) {
  RandomLimits random;
  for (int trial = 0; trial < 300; ++trial) {
    const JerkLimitConfig config = random.Next();
    const double way = std::exp(3.0 + 4.0 * random.Uniform()) * (trial % 2 == 0 ? 1.0 : -1.0);
    const double least = LeastSamples(config, std::abs(way));
    std::vector<double> input(static_cast<std::size_t>(least) + 10, 500.0 + way);
    input[0] = 500.0;
    const std::vector<double> y = Follow(config, input);
    const double sign = way > 0.0 ? 1.0 : -1.0;
    std::size_t samples = 0;
    for (std::size_t k = 1; k < y.size(); ++k) {
      ASSERT_GE(sign * (y[k] - y[k - 1]), -1e-10) << trial;  // never back
      ASSERT_LE(sign * (y[k] - input[k]), 1e-10) << trial;   // never beyond
      if (std::abs(y[k] - input[k]) > 1e-9) samples = k;
    }
    EXPECT_LE(static_cast<double>(samples), least + 1.5) << trial;
    EXPECT_EQ(y.back(), input.back()) << trial;
  }
}

/// The same filter from its definition, slowly: every stop is simulated, and the equation for the
/// acceleration is solved by halving.
class SlowFilter {
 public:
  SlowFilter(const JerkLimitConfig& config, double start)
      : v_max_(config.max_velocity_per_s / kRate_hz),
        a_max_(config.max_acceleration_per_s2 / (kRate_hz * kRate_hz)),
        j_max_(config.max_jerk_per_s3 / (kRate_hz * kRate_hz * kRate_hz)),
        y_(start) {}

  double Step(double target) {
    double low = std::max(a_ - j_max_, -a_max_);
    double high = std::min(a_ + j_max_, a_max_);
    const double floor = Solve(low, high, [&](double a) { return LevelOf(v_ + a, a) + v_max_; });
    const double ceiling = Solve(low, high, [&](double a) { return LevelOf(v_ + a, a) - v_max_; });
    low = std::max(low, floor);
    high = std::min(high, ceiling);
    a_ = Solve(low, high, [&](double a) { return y_ + v_ + a + Stop(v_ + a, a) - target; });
    v_ += a_;
    return y_ += v_;
  }

 private:
  /// The root of a rising function, or the end that is nearest to it.
  template <class Function>
  static double Solve(double low, double high, const Function& function) {
    for (int i = 0; i < 60; ++i) {
      const double middle = 0.5 * (low + high);
      (function(middle) > 0.0 ? high : low) = middle;
    }
    return 0.5 * (low + high);
  }
  /// The velocity when the acceleration has come back to 0 as fast as it can.
  double LevelOf(double v, double a) const {
    while (std::abs(a) > j_max_) v += a -= std::copysign(j_max_, a);
    return v;
  }
  /// S^-1 by halving.
  double LastAcceleration(double v) const {
    const double top = std::abs(v) + j_max_;
    return std::copysign(Solve(0.0, top, [&](double a) { return LevelOf(a, a) - std::abs(v); }), v);
  }
  double Stop(double v, double a) const {
    double way = 0.0;
    for (int k = 0; k < 100000 && std::abs(v) + std::abs(a) > 1e-12 * j_max_; ++k) {
      a = std::clamp(-LastAcceleration(v), std::max(a - j_max_, -a_max_),
                     std::min(a + j_max_, a_max_));
      v += a;
      way += v;
    }
    return way;
  }

  double v_max_, a_max_, j_max_;
  double y_, v_ = 0.0, a_ = 0.0;
};

TEST(JerkLimit, IsWhatItsDefinitionSays) {
  const JerkLimitConfig config{
      .max_velocity_per_s = 8e3, .max_acceleration_per_s2 = 1.1e6, .max_jerk_per_s3 = 3e8};
  std::vector<double> input;
  for (int k = 0; k < 160; ++k) {
    input.push_back(k % 40 == 39 ? 300.0 : 500.0 + 60.0 * std::sin(0.3 * k) + 7.0 * (k % 3));
  }
  const std::vector<double> y = Follow(config, input);
  SlowFilter slow(config, input[0]);
  for (std::size_t k = 0; k < input.size(); ++k) {
    ASSERT_NEAR(y[k], slow.Step(input[k]), 1e-8) << k;
  }
}

TEST(JerkLimit, FollowsARampByItsStoppingWay) {
  const JerkLimitConfig config{
      .max_velocity_per_s = 5000.0, .max_acceleration_per_s2 = 2e4, .max_jerk_per_s3 = 1e6};
  constexpr double kVelocity = 1000.0;
  std::vector<double> input;
  for (int k = 0; k < 1500; ++k) input.push_back(kVelocity * k / kRate_hz);
  const double lag = input.back() - Follow(config, input).back();
  // Down to -A with jerk J, A held, back to 0: the mean velocity is half.
  const double stop_s = kVelocity / config.max_acceleration_per_s2 +
                        config.max_acceleration_per_s2 / config.max_jerk_per_s3;
  EXPECT_NEAR(lag, 0.5 * kVelocity * stop_s, kVelocity / kRate_hz);
}

TEST(JerkLimit, RefusesLimitsThatAreNone) {
  EXPECT_THROW(MakeFilter(JerkLimitConfig{.max_velocity_per_s = 0.0}, 1, kRate_hz), SettingError);
  EXPECT_THROW(MakeFilter(JerkLimitConfig{.max_jerk_per_s3 = -1.0}, 1, kRate_hz), SettingError);
}

}  // namespace
}  // namespace gauntlet::controller
