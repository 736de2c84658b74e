#include "sim/score/smoothness.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>

#include "sim/score/delay.h"
#include "tests/score/signals.h"

namespace gauntlet::sim {
namespace {

/// The speed of the example in the published program (siva82kb/SPARC, scripts/smoothness.py).
std::vector<double> PublishedSpeed() {
  std::vector<double> speed(200);
  for (int n = 0; n < 200; ++n) speed[n] = std::exp(-5.0 * std::pow(-1.0 + 0.01 * n, 2));
  return speed;
}

TEST(Smoothness, SpectralArcLengthIsThePublishedValue) {
  Fourier fourier;
  EXPECT_NEAR(SpectralArcLength(PublishedSpeed(), 100.0, fourier), -1.41403, 5e-6);
}

TEST(Smoothness, LogDimensionlessJerkIsThePublishedValue) {
  EXPECT_NEAR(LogDimensionlessJerk(PublishedSpeed(), 100.0), -5.81636, 5e-6);
  EXPECT_NEAR(std::exp(-LogDimensionlessJerk(PublishedSpeed(), 100.0)), 335.74684, 5e-4);
}

/// Angle of a minimum-jerk movement over `amplitude` in `duration_s`.
double MinimumJerk(double t, double duration_s) {
  const double x = std::clamp(t / duration_s, 0.0, 1.0);
  return x * x * x * (10.0 - 15.0 * x + 6.0 * x * x);
}

TEST(Smoothness, LogDimensionlessJerkOfAMinimumJerkMovementIsAnalytic) {
  const auto speed =
      Sampled(1.0, 1000.0, [](double t) { return 30.0 * t * t * (1 - t) * (1 - t); });
  const double analytic = -std::log(720.0 / (1.875 * 1.875));
  EXPECT_NEAR(analytic, -5.3220, 1e-4);
  EXPECT_NEAR(LogDimensionlessJerk(speed, 1000.0), analytic, 0.01);
}

TEST(Smoothness, DoesNotDependOnAmplitudeOrDuration) {
  Fourier fourier;
  const auto speed = PublishedSpeed();
  auto larger = speed;
  for (double& value : larger) value *= -7.0;
  EXPECT_NEAR(SpectralArcLength(larger, 100.0, fourier), SpectralArcLength(speed, 100.0, fourier),
              1e-12);
  EXPECT_NEAR(LogDimensionlessJerk(larger, 100.0), LogDimensionlessJerk(speed, 100.0), 1e-9);
  EXPECT_NEAR(LogDimensionlessJerk(speed, 50.0), LogDimensionlessJerk(speed, 100.0), 1e-9);
}

Smoothness OfHand(const std::function<double(double)>& hand, double delay_samples = 0.0) {
  const std::vector<Movement> movements{
      {.begin = 1000, .end = 2000, .to_rad = 1.0, .within = {0, 3000}}};
  Fourier fourier;
  return MovementSmoothness(Sampled(3.0, 1000.0, hand), 1000.0, movements, delay_samples, fourier);
}

TEST(Smoothness, OfAMinimumJerkMovementOfTheHandIsAnalytic) {
  const auto smooth = OfHand([](double t) { return MinimumJerk(t - 1.0, 1.0); });
  // The jerk jumps at both ends; at 100 Hz a part of that is lost.
  EXPECT_NEAR(smooth.ldlj, -5.3220, 0.1);
  EXPECT_GT(smooth.sparc, -1.6);
}

TEST(Smoothness, OfAMovementIsThatOfItsVelocityAtAllTicks) {
  const auto smooth = OfHand([](double t) { return MinimumJerk(t - 1.0, 1.0); });
  const auto speed =
      Sampled(1.0, 1000.0, [](double t) { return 30.0 * t * t * (1 - t) * (1 - t); });
  Fourier fourier;
  EXPECT_NEAR(smooth.sparc / SpectralArcLength(speed, 1000.0, fourier), 1.0, 0.01);
}

/// Random turns of a hand, which trembles.
class RandomTurns {
 public:
  explicit RandomTurns(std::uint64_t seed) {
    RandomStream random(seed, "random turns");
    for (Wave& wave : waves_) {
      wave.hz = 0.2 + 1.2 * random.Uniform();
      wave.rad = 0.3 * random.Uniform() / (0.3 + wave.hz);
      wave.phase = random.Uniform();
    }
    waves_[0] = {.hz = 8.3, .rad = 0.004, .phase = 0.0};
  }
  double At(int tick) const {
    double angle = 0.0;
    for (const Wave& wave : waves_) {
      angle += wave.rad * std::sin(2.0 * kPi * (0.001 * wave.hz * tick + wave.phase));
    }
    return angle;
  }

 private:
  struct Wave {
    double hz;
    double rad;
    double phase;
  };
  std::array<Wave, 9> waves_{};
};

TEST(Smoothness, DoesNotDependOnWhenTheTrialBegan) {
  constexpr int kDelay = 60;
  for (const std::uint64_t seed : {1, 2, 3}) {
    const RandomTurns turns(seed);
    const auto score = [&](int shift) {
      std::vector<double> wearer(12000), hand(12000);
      for (int n = 0; n < 12000; ++n) {
        wearer[n] = turns.At(n - shift);
        hand[n] = turns.At(n - shift - kDelay);
      }
      std::vector<Movement> movements = AnalyseWearer(wearer, 1000.0, {}).movements;
      // The first and the last depend on where the signal is cut off.
      movements.pop_back();
      movements.erase(movements.begin());
      EXPECT_GT(movements.size(), 5u);
      Fourier fourier;
      return MovementSmoothness(hand, 1000.0, movements, kDelay, fourier);
    };
    const Smoothness at_once = score(0);
    for (int shift = 1; shift <= 9; ++shift) {
      EXPECT_NEAR(score(shift).sparc / at_once.sparc, 1.0, 1e-6) << seed << ' ' << shift;
      EXPECT_NEAR(score(shift).ldlj / at_once.ldlj, 1.0, 1e-6) << seed << ' ' << shift;
    }
  }
}

TEST(Smoothness, OfALaterHandIsNearlyTheSame) {
  // The delay is that which the scores find, no whole number of ticks.
  for (const std::uint64_t seed : {1, 2, 3}) {
    std::vector<double> wearer(40000), hand(40000);
    const RandomTurns turns(seed);
    for (int n = 0; n < 40000; ++n) wearer[n] = turns.At(n);
    const WearerMotion motion = AnalyseWearer(wearer, 1000.0, {});
    Fourier fourier;
    const auto sparc = [&](int delay) {
      for (int n = 0; n < 40000; ++n) hand[n] = turns.At(n - delay);
      const auto found = DelaySamples(wearer, hand, 1000.0, 0.0, {{0, 40000}}, fourier);
      return MovementSmoothness(hand, 1000.0, motion.movements, found.value(), fourier).sparc;
    };
    const double at_first = sparc(60);
    for (int later = 1; later <= 9; ++later) {
      EXPECT_NEAR(sparc(60 + later) / at_first, 1.0, 0.01) << seed << ' ' << later;
    }
  }
}

TEST(Smoothness, OfALateHandIsThatOfTheHandInTime) {
  const auto in_time = OfHand([](double t) { return MinimumJerk(t - 1.0, 1.0); });
  const auto late = OfHand([](double t) { return MinimumJerk(t - 1.11, 1.0); }, 110.0);
  EXPECT_NEAR(late.sparc, in_time.sparc, 1e-6);
  EXPECT_NEAR(late.ldlj, in_time.ldlj, 1e-6);
}

TEST(Smoothness, FallsWithTrembling) {
  const auto with_tremble = [](double amplitude) {
    return OfHand([amplitude](double t) {
      return MinimumJerk(t - 1.0, 1.0) + amplitude * std::sin(2.0 * kPi * 7.0 * t);
    });
  };
  EXPECT_LT(with_tremble(0.01).sparc, with_tremble(0.0).sparc - 0.1);
  EXPECT_LT(with_tremble(0.03).sparc, with_tremble(0.01).sparc);
  EXPECT_LT(with_tremble(0.01).ldlj, with_tremble(0.0).ldlj - 0.5);
  EXPECT_LT(with_tremble(0.03).ldlj, with_tremble(0.01).ldlj);
}

TEST(Smoothness, DoesNotExistWithoutMotion) {
  Fourier fourier;
  EXPECT_TRUE(std::isnan(SpectralArcLength(std::vector<double>(50, 0.0), 100.0, fourier)));
  EXPECT_TRUE(std::isnan(LogDimensionlessJerk(std::vector<double>(50, 0.0), 100.0)));
  EXPECT_TRUE(std::isnan(OfHand([](double) { return 0.2; }).sparc));
  EXPECT_TRUE(std::isnan(MovementSmoothness(Noise(3000, 1), 1000.0, {}, 0.0, fourier).ldlj));
  const std::vector<Movement> outside{{.begin = 0, .end = 1000, .within = {0, 3000}},
                                      {.begin = 2500, .end = 3000, .within = {0, 3000}}};
  EXPECT_TRUE(std::isnan(MovementSmoothness(Noise(3000, 1), 1000.0, outside, 0.0, fourier).sparc));
}

}  // namespace
}  // namespace gauntlet::sim
