#include "sim/score/jitter.h"

#include <gtest/gtest.h>

#include "sim/score/score.h"
#include "sim/score/score_config.h"
#include "sim/score/tracking.h"
#include "tests/score/signals.h"

namespace gauntlet::sim {
namespace {

double JitterRms(const std::vector<double>& angle, double rate_hz = 1000.0,
                 double above_hz = 10.0) {
  Fourier fourier;
  const Signal high = Trembling(OneChannel(angle), rate_hz, above_hz, fourier).values;
  return Rms(std::span(high.data(), static_cast<std::size_t>(high.size())));
}

double SineJitter(double frequency_hz, double rate_hz = 1000.0, double above_hz = 10.0) {
  return JitterRms(Sampled(6.0, rate_hz,
                           [&](double t) {
                             return std::sqrt(2.0) * std::sin(2.0 * kPi * frequency_hz * t + 0.3);
                           }),
                   rate_hz, above_hz);
}

TEST(Jitter, PassesWhatTremblesAndStopsWhatMoves) {
  for (const double rate_hz : {1000.0, 500.0, 200.0}) {
    for (const double hz : {12.0, 20.0, 50.0, 90.0})
      EXPECT_NEAR(SineJitter(hz, rate_hz), 1.0, 5e-3);
    for (const double hz : {0.1, 1.0, 3.0, 5.0, 8.0}) EXPECT_LT(SineJitter(hz, rate_hz), 3e-4);
    EXPECT_NEAR(SineJitter(10.0, rate_hz), 0.5, 0.01);
  }
}

TEST(Jitter, BeginsWhereItIsSaidTo) {
  for (const double above_hz : {3.0, 6.6, 40.0}) {
    EXPECT_NEAR(SineJitter(1.2 * above_hz, 1000.0, above_hz), 1.0, 5e-3) << above_hz;
    EXPECT_NEAR(SineJitter(above_hz, 1000.0, above_hz), 0.5, 0.01) << above_hz;
    EXPECT_LT(SineJitter(0.8 * above_hz, 1000.0, above_hz), 3e-4) << above_hz;
  }
}

TEST(Jitter, OfHalfADegreeAt12HertzUnderALargeMotionIsHalfADegree) {
  const auto angle = Sampled(10.0, 1000.0, [](double t) {
    return 45.0 * std::sin(2.0 * kPi * 1.0 * t) +
           0.5 * std::sqrt(2.0) * std::sin(2.0 * kPi * 12 * t);
  });
  EXPECT_NEAR(JitterRms(angle), 0.50, 0.01);
}

TEST(Jitter, SaysHowLongAMotionMustBe) {
  const std::size_t jitter = MetricIndex("jitter_rms_deg");
  const double least_s = 1e-3 * static_cast<double>(TremblingTicks(1000.0, 10.0));
  EXPECT_EQ(WhyNoValue(jitter, 10.0, least_s), "");
  EXPECT_EQ(WhyNoValue(jitter, 10.0, 0.5),
            "it needs 1.4 s of motion without a gap, and there are 0.5 s");
  EXPECT_NE(WhyNoValue(jitter, 5.0, least_s), "");  // a lower edge needs more
  EXPECT_EQ(WhyNoValue(MetricIndex("tracking_rmse_deg"), 10.0, 0.1), "");
}

TEST(Jitter, OfRampsAndConstantsIsZeroEvenAtTheEnds) {
  EXPECT_LT(JitterRms(Sampled(3.0, 1000.0, [](double t) { return 100.0 + 50.0 * t; })), 1e-9);
}

TEST(Jitter, OfWhiteNoiseHasTheShareOfTheBand) {
  // White noise of variance 1 up to 500 Hz; 490 of 500 Hz pass.
  EXPECT_NEAR(JitterRms(Noise(60000, 11)), std::sqrt(0.98), 0.01);
}

TEST(Jitter, HasNoPhase) {
  const auto tremble = [](double t) { return std::sin(2.0 * kPi * 15.0 * t); };
  Fourier fourier;
  const auto high = Trembling(OneChannel(Sampled(4.0, 1000.0, tremble)), 1000.0, 10.0, fourier);
  for (int n = 0; n < high.values.rows(); ++n) {
    ASSERT_NEAR(high.values(n, 0), tremble((n + high.first_sample) / 1000.0), 1e-3);
  }
}

TEST(Jitter, KeepsChannelsApart) {
  Signal both(3000, 3);
  const auto noise = Noise(9000, 2);
  for (int i = 0; i < both.size(); ++i) both.data()[i] = noise[i];
  Fourier fourier;
  const Signal together = Trembling(both, 1000.0, 10.0, fourier).values;
  for (int c = 0; c < 3; ++c) {
    const Signal alone = Trembling(both.col(c), 1000.0, 10.0, fourier).values;
    EXPECT_LT((together.col(c) - alone).cwiseAbs().maxCoeff(), 1e-12);
  }
}

TEST(Jitter, NeedsTheTicksThatItSays) {
  for (const double above_hz : {2.0, 10.0, 33.0}) {
    const auto needed = static_cast<std::size_t>(TremblingTicks(1000.0, above_hz));
    EXPECT_NEAR(static_cast<double>(needed), 13600.0 / above_hz, 100.0 / above_hz);
    EXPECT_TRUE(std::isnan(JitterRms(Noise(needed - 1, 3), 1000.0, above_hz))) << above_hz;
    EXPECT_FALSE(std::isnan(JitterRms(Noise(needed, 3), 1000.0, above_hz))) << above_hz;
  }
}

TEST(ScoreConfig, RefusesAnEdgeThatATrialIsTooShortFor) {
  EXPECT_NO_THROW(ScoreConfig{}.Check(1000.0, 100));  // such a trial has no jitter
  const ScoreConfig low{.jitter_above_hz = 2.5};
  EXPECT_NO_THROW(low.Check(1000.0, 6000));
  try {
    low.Check(1000.0, 3000);
    FAIL();
  } catch (const controller::SettingError& error) {
    EXPECT_STREQ(error.what(),
                 "jitter_above_hz: is 2.5, must be at least 4.6 in a trial of 3 s: the high pass "
                 "needs 5.42 s");
  }
  EXPECT_NO_THROW(ScoreConfig{.jitter_above_hz = 4.6}.Check(1000.0, 3000));
}

TEST(Jitter, DoesNotExistForShortSignalsAndSlowRates) {
  EXPECT_TRUE(std::isnan(JitterRms(Noise(1300, 1))));
  EXPECT_FALSE(std::isnan(JitterRms(Noise(1400, 1))));
  EXPECT_TRUE(std::isnan(JitterRms(Noise(1400, 1), 24.0)));
  EXPECT_TRUE(std::isnan(JitterRms({})));
}

}  // namespace
}  // namespace gauntlet::sim
