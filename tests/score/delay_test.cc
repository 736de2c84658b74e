#include "sim/score/delay.h"

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <algorithm>

#include "tests/score/signals.h"

namespace gauntlet::sim {
namespace {

constexpr double kRate_hz = 1000.0;

std::optional<double> Delay_ms(const std::vector<double>& leader,
                               const std::vector<double>& follower, double earliest_s = -0.1) {
  Fourier fourier;
  auto delay = DelaySamples(leader, follower, kRate_hz, earliest_s, All(leader), fourier);
  if (delay) *delay *= 1000.0 / kRate_hz;
  return delay;
}

/// Several sines that never repeat within the signal, about as a hand moves.
double Motion(double time_s) {
  return 0.5 * std::sin(2.0 * kPi * 0.41 * time_s) + 0.3 * std::sin(2.0 * kPi * 1.13 * time_s + 1) +
         0.1 * std::sin(2.0 * kPi * 2.71 * time_s + 2);
}

class DelayOfSines : public testing::TestWithParam<std::tuple<double, double>> {};

TEST_P(DelayOfSines, IsTheTrueDelay) {
  const auto [frequency_hz, delay_ms] = GetParam();
  const auto sine = [f = frequency_hz](double t) { return std::sin(2.0 * kPi * f * t); };
  const auto leader = Sampled(10.0, kRate_hz, sine);
  const auto follower = Sampled(
      10.0, kRate_hz, [&, d = delay_ms](double t) { return 3.0 + 0.7 * sine(t - d / 1e3); });
  const auto delay = Delay_ms(leader, follower);
  ASSERT_TRUE(delay);
  EXPECT_NEAR(*delay, delay_ms, 0.05);
}

// 3 Hz is the case that gave 338 to 381 ms without a bound.
INSTANTIATE_TEST_SUITE_P(Delay, DelayOfSines,
                         testing::Combine(testing::Values(0.2, 0.5, 1.0, 3.0),
                                          testing::Values(-20.0, 0.0, 0.4, 37.0, 110.3)));

TEST(Delay, OfARandomMotionIs37Milliseconds) {
  const auto leader = Sampled(20.0, kRate_hz, Motion);
  const auto follower = Sampled(20.0, kRate_hz, [](double t) { return Motion(t - 0.037); });
  EXPECT_NEAR(Delay_ms(leader, follower).value(), 37.0, 0.01);
}

TEST(Delay, IsFoundUnderNoise) {
  const auto leader = Sampled(20.0, kRate_hz, Motion);
  auto follower = Sampled(20.0, kRate_hz, [](double t) { return Motion(t - 0.037); });
  const auto noise = Noise(follower.size(), 3);
  for (std::size_t n = 0; n < follower.size(); ++n) follower[n] += 0.5 * kRadPerDeg * noise[n];
  EXPECT_NEAR(Delay_ms(leader, follower).value(), 37.0, 1.0);
}

TEST(Delay, OfSingleMovementBetweenHoldsIsFound) {
  const auto step = [](double t) { return 1.0 / (1.0 + std::exp(-(t - 5.0) / 0.08)); };
  const auto leader = Sampled(10.0, kRate_hz, step);
  const auto follower = Sampled(10.0, kRate_hz, [&](double t) { return step(t - 0.037); });
  EXPECT_NEAR(Delay_ms(leader, follower).value(), 37.0, 0.1);
}

TEST(Delay, OfAFirstOrderLowPassIsItsGroupDelayForSlowMotion) {
  const double time_constant_s = 0.05;
  const auto leader = Sampled(40.0, kRate_hz, [](double t) { return std::sin(kPi * t * 0.4); });
  std::vector<double> follower(leader.size());
  double state = 0.0;
  for (std::size_t n = 0; n < leader.size(); ++n) {
    state += (leader[n] - state) * (1.0 - std::exp(-1.0 / (kRate_hz * time_constant_s)));
    follower[n] = state;
  }
  const double omega =
      kPi * 0.4;  // phase delay atan(omega tau) / omega, less half a sample of hold
  EXPECT_NEAR(Delay_ms(leader, follower).value(),
              1e3 * std::atan(omega * time_constant_s) / omega - 0.5, 0.2);
}

TEST(Delay, DoesNotExistForConstantOrUnrelatedSignals) {
  const auto motion = Sampled(10.0, kRate_hz, Motion);
  const auto constant = Sampled(10.0, kRate_hz, [](double) { return 0.3; });
  const auto opposite = Sampled(10.0, kRate_hz, [](double t) { return -Motion(t); });
  EXPECT_FALSE(Delay_ms(constant, motion));
  EXPECT_FALSE(Delay_ms(motion, constant));
  EXPECT_FALSE(Delay_ms(constant, constant));
  EXPECT_FALSE(Delay_ms({}, {}));
  EXPECT_FALSE(Delay_ms({1, 2, 3}, {1, 2, 3}));
  const auto ramp = Sampled(10.0, kRate_hz, [](double t) { return t; });
  const auto falling = Sampled(10.0, kRate_hz, [](double t) { return -t; });
  EXPECT_FALSE(Delay_ms(ramp, falling));
}

TEST(Delay, DoesNotExistBetweenMotionsThatAreUnrelated) {
  // They correlate a little at some lag.
  for (const double hz : {0.29, 0.53, 0.83, 1.37}) {
    const auto other = Sampled(30.0, kRate_hz, [hz](double t) {
      return 0.4 * std::sin(2.0 * kPi * hz * t) + 0.2 * std::sin(2.0 * kPi * 1.7 * hz * t + 2.0);
    });
    EXPECT_FALSE(Delay_ms(Sampled(30.0, kRate_hz, Motion), other)) << hz;
  }
}

TEST(Delay, NeedsAQuarterOfTheMotionToBeTheWearers) {
  // Motions that do not correlate: the share of the first is the square of the coefficient.
  const auto leader = Sampled(40.0, kRate_hz, [](double t) { return std::sin(2.0 * kPi * t); });
  const auto with_other = [&](double amplitude) {
    return Delay_ms(leader, Sampled(40.0, kRate_hz, [&](double t) {
                      return std::sin(2.0 * kPi * (t - 0.05)) +
                             amplitude * std::sin(2.0 * kPi * 7.3 * t);
                    }));
  };
  EXPECT_NEAR(with_other(1.6).value(), 50.0, 2.0);  // 1 / (1 + 1.6^2) = 0.28
  EXPECT_FALSE(with_other(1.9));                    // 0.22
}

/// From 0 before `begin_s` to 1 after `end_s`, smoothly.
double Rise(double time_s, double begin_s, double end_s) {
  const double share = std::clamp((time_s - begin_s) / (end_s - begin_s), 0.0, 1.0);
  return share * share * (3.0 - 2.0 * share);
}

TEST(Delay, DoesNotExistWhereAnObjectPushesTheFingerTheOtherWay) {
  // As a thumb on a bottle: the wearer closes it by 10 deg, the bottle opens it, and it creeps.
  // Only at lags that leave nothing but the creep do both go the same way.
  const auto leader = Sampled(
      6.4, kRate_hz, [](double t) { return (60.0 - 10.0 * Rise(t, 0.9, 1.7)) * kRadPerDeg; });
  const auto follower = Sampled(6.4, kRate_hz, [](double t) {
    return (60.0 - 3.3 * Rise(t, 0.95, 1.2) + 8.0 * Rise(t, 1.2, 1.6) - 1.8 * Rise(t, 1.6, 6.4)) *
           kRadPerDeg;
  });
  EXPECT_FALSE(Delay_ms(leader, follower));
}

TEST(Delay, DoesNotExistWhereOnlyTheRestOfTheWearersMotionIsFollowed) {
  // The hand follows a tremor 0.35 s ahead of the wearer, and not the one movement, which is ten
  // times as large. Only at lags that leave the movement out do both go the same way.
  const auto tremor = [](double t) { return std::sin(2.0 * kPi * t); };
  const auto leader =
      Sampled(10.0, kRate_hz, [&](double t) { return (t < 0.3 ? 0.0 : 1.0) + 0.02 * tremor(t); });
  const auto follower = Sampled(10.0, kRate_hz, [&](double t) { return 0.3 * tremor(t + 0.35); });
  EXPECT_FALSE(Delay_ms(leader, follower));
}

TEST(Delay, OfNotANumberDoesNotExist) {
  const auto motion = Sampled(10.0, kRate_hz, Motion);
  auto broken = motion;
  broken[100] = NAN;
  EXPECT_FALSE(Delay_ms(motion, broken));
  EXPECT_FALSE(Delay_ms(broken, motion));
}

TEST(Delay, OfBurstsIsThatOfTheirCycleAndNotOfTheirEnvelope) {
  // 3 Hz for 1.4 s, then rest: the strongest frequency is that of the bursts, 0.35 Hz.
  const auto bursts = [](double t) {
    return std::fmod(t, 2.8) < 1.4 ? std::sin(2.0 * kPi * 3.0 * std::fmod(t, 2.8)) : 0.0;
  };
  const auto leader = Sampled(9.0, kRate_hz, bursts);
  for (const double delay_ms : {12.0, 40.0, 100.0, 300.0}) {
    const auto follower = Sampled(
        9.0, kRate_hz, [&](double t) { return t < 0.4 ? 0.0 : bursts(t - delay_ms / 1e3); });
    EXPECT_NEAR(Delay_ms(leader, follower, 0.0).value(), delay_ms, 1.0);
  }
}

TEST(Delay, OfAMotionThatRepeatsIsOneOfAPeriodFromTheEarliestOn) {
  const auto sine = [](double t) { return std::sin(2.0 * kPi * 3.0 * t); };
  const auto leader = Sampled(10.0, kRate_hz, sine);
  const auto follower = Sampled(10.0, kRate_hz, [&](double t) { return sine(t - 0.177); });
  EXPECT_NEAR(Delay_ms(leader, follower, 0.0).value(), 177.0, 0.1);
  EXPECT_NEAR(Delay_ms(leader, follower, 0.115).value(), 177.0, 0.1);
  EXPECT_NEAR(Delay_ms(leader, follower, 0.3).value(), 177.0 + 1000.0 / 3.0, 0.5);
  EXPECT_NEAR(Delay_ms(leader, follower, -0.2).value(), 177.0 - 1000.0 / 3.0, 0.5);
}

TEST(Delay, OfAMotionThatRepeatsMayBeTheEarliest) {
  // With a little noise a lag of one period may fit better than the true one, 0.
  const auto leader =
      Sampled(40.0, kRate_hz, [](double t) { return std::sin(2.0 * kPi * 0.3 * t); });
  auto follower = leader;
  double mixed = 0.5;
  for (double& value : follower) {
    mixed = std::fmod(9.0 * mixed + 0.1234567, 1.0);
    value += 0.02 * (mixed - 0.5);
  }
  EXPECT_NEAR(Delay_ms(leader, follower, 0.0).value(), 0.0, 2.0);
}

// A long signal is correlated block by block, see CrossProducts().

TEST(Delay, OfALongMotionIsFoundWhereBlocksMeet) {
  // Two blocks: the one movement lies around their border. Wrong: what a block's neighbours have
  // within the lags is left out.
  constexpr double kDuration_s = 600.0;
  const auto wave = [](double t) {
    return Motion(t) * std::exp(-std::pow(t - 0.5 * kDuration_s, 2));
  };
  const auto leader = Sampled(kDuration_s, kRate_hz, wave);
  for (const double delay_ms : {37.0, -20.0, 400.0}) {
    const auto follower =
        Sampled(kDuration_s, kRate_hz, [&](double t) { return wave(t - delay_ms / 1e3); });
    EXPECT_NEAR(Delay_ms(leader, follower).value(), delay_ms, 0.01);
  }
}

TEST(Delay, OfAnHourTakesLittleMemory) {
  const auto leader = Sampled(3600.0, kRate_hz, Motion);
  const auto follower = Sampled(3600.0, kRate_hz, [](double t) { return Motion(t - 0.037); });
  rusage before{}, after{};
  getrusage(RUSAGE_SELF, &before);
  EXPECT_NEAR(Delay_ms(leader, follower).value(), 37.0, 0.01);
  getrusage(RUSAGE_SELF, &after);
  EXPECT_LT(after.ru_maxrss - before.ru_maxrss, 96 << 10);  // KiB; by one transform: 260 MB
}

TEST(Delay, DoesNotExistWhereManyLagsFitAsWell) {
  // The hand is up for long around each short pulse of the wearer.
  const auto pulse = [](double t, double begin, double end) {
    const double phase = std::fmod(t, 2.3 + 0.1 * std::floor(t / 7.0));
    return phase >= begin && phase < end ? 1.0 : 0.0;
  };
  const auto leader = Sampled(20.0, kRate_hz, [&](double t) { return pulse(t, 0.5, 0.6); });
  const auto follower = Sampled(20.0, kRate_hz, [&](double t) { return pulse(t, 0.6, 1.0); });
  EXPECT_FALSE(Delay_ms(leader, follower));
}

TEST(Delay, DoesNotExistWhereTheHandMovesTwice) {
  const auto leader = Sampled(20.0, kRate_hz, Motion);
  const auto follower = Sampled(
      20.0, kRate_hz, [](double t) { return 0.50 * Motion(t - 0.1) + 0.5 * Motion(t - 0.75); });
  EXPECT_FALSE(Delay_ms(leader, follower));
}

TEST(RepeatPeriod, IsThatOfAMotionThatRepeats) {
  Fourier fourier;
  const auto period_s = [&](const std::vector<double>& motion) {
    return RepeatPeriod_s(motion, kRate_hz, All(motion), fourier);
  };
  for (const double hz : {0.5, 1.0, 3.0, 5.0}) {
    const auto sine = [hz](double t) { return std::sin(2.0 * kPi * hz * t); };
    EXPECT_NEAR(period_s(Sampled(10.0, kRate_hz, sine)).value(), 1.0 / hz, 0.01) << hz;
  }
  EXPECT_FALSE(period_s(Sampled(20.0, kRate_hz, [](double t) { return std::sin(0.4 * t * t); })));
  EXPECT_FALSE(period_s(Sampled(10.0, kRate_hz, [](double t) { return t; })));
  EXPECT_FALSE(period_s(Sampled(10.0, kRate_hz, [](double) { return 0.3; })));
  EXPECT_FALSE(period_s({}));
}

/// A motion of a random kind: sines, taps, bursts, steps, or sums of sines that do not repeat.
std::function<double(double)> RandomMotion(RandomStream& random) {
  const double hz = random.Uniform(0.3, 5.0);
  const double share = random.Uniform(0.2, 0.8);
  const double at_s = random.Uniform(0.5, 1.5);
  switch (static_cast<int>(random.Uniform(0.0, 5.0))) {
    case 0:
      return [=](double t) { return std::sin(2.0 * kPi * hz * t); };
    case 1:
      return [=](double t) { return Rise(t * hz - std::floor(t * hz), 0.0, share); };
    case 2:
      return [=](double t) {
        const double phase = t / (3.0 * at_s) - std::floor(t / (3.0 * at_s));
        return phase < share ? std::sin(2.0 * kPi * hz * t) : 0.0;
      };
    case 3:
      return [=](double t) {
        double sum = 0.0;
        for (int i = 0; i < 20; ++i)
          sum += std::cos(7.0 * i * i) * Rise(t, i * at_s, i * at_s + 0.1);
        return sum;
      };
    default:
      return [=](double t) { return Motion(t * (0.5 + share)); };
  }
}

TEST(Delay, IsRightOrNotThereOrOneOfAPeriodWhateverTheMotion) {
  RandomStream random(7, "motions");
  Fourier fourier;
  int found = 0;
  for (int i = 0; i < 300; ++i) {
    const std::function<double(double)> motion = RandomMotion(random);
    const double delay_ms = std::floor(550.0 * random.Uniform()) - 50.0;
    const auto leader = Sampled(10.0, kRate_hz, motion);
    const auto follower =
        Sampled(10.0, kRate_hz, [&](double t) { return 0.9 * motion(t - delay_ms / 1e3) + 0.1; });
    const auto delay = Delay_ms(leader, follower, 0.0);
    if (!delay) continue;
    ++found;
    const auto period_s = RepeatPeriod_s(leader, kRate_hz, All(leader), fourier);
    const double error_ms =
        period_s ? std::remainder(*delay - delay_ms, 1e3 * *period_s) : *delay - delay_ms;
    EXPECT_NEAR(error_ms, 0.0, period_s ? 12.0 : 2.0) << i << ' ' << delay_ms;
  }
  EXPECT_GE(found, 240);
}

TEST(AlignedRms, VanishesForAPureDelay) {
  const auto leader = Sampled(5.0, kRate_hz, Motion);
  for (const double delay : {-12.0, 0.0, 37.0, 37.4}) {
    const auto follower = Sampled(5.0, kRate_hz, [&](double t) { return Motion(t - delay / 1e3); });
    EXPECT_NEAR(AlignedRms(leader, follower, delay, All(leader)), 0.0, 1e-5);
  }
}

TEST(AlignedRms, KeepsAnOffset) {
  const auto leader = Sampled(5.0, kRate_hz, Motion);
  const auto follower = Sampled(5.0, kRate_hz, [](double t) { return 0.25 + Motion(t - 0.05); });
  EXPECT_NEAR(AlignedRms(leader, follower, 50.0, All(leader)), 0.25, 1e-9);
}

}  // namespace
}  // namespace gauntlet::sim
