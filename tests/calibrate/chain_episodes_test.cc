// A log of several episodes: what some say of the hand holds for the others, or it is told.
#include "sim/fit/chain_episodes.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/calibrate/made_up_servo.h"

namespace gauntlet::sim {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

using test::LimitedSteps;
using test::MakeUpEpisode;

/// Whatever the size of the steps. Wrong: a lag that grows with them.
TEST(ChainEpisodes, GiveAServoWithASpeedLimitOneDeadTime) {
  std::mt19937 random(4);
  std::uniform_real_distribution<double> dead_s(0.02, 0.12), late(0.0, 0.99);
  int held = 0, told = 0, all = 0;
  for (const double rate_hz : {50.0, 100.0}) {
    for (const double most_deg : {10.0, 40.0, 100.0}) {
      for (const bool two_levels : {false, true}) {
        for (int i = 0; i < 2; ++i) {
          const double dead = std::round(1e3 * dead_s(random)) * 1e-3;
          ChainEpisodes one;
          one.logs.push_back(
              LimitedSteps(most_deg, two_levels, dead, rate_hz, late(random), random, 20.0));
          const ChainEstimate found = IdentifyChain(std::move(one)).fits[0].dead_time_ms;
          ++all;
          if (std::isnan(found.value)) continue;  // withheld
          ++told;
          held += found.low <= 1e3 * dead && 1e3 * dead <= found.high ? 1 : 0;
        }
      }
    }
  }
  EXPECT_GE(held, 0.93 * told) << held << " of " << told;
  EXPECT_GE(told, 0.8 * all);
}

/// Wrong: the mean of the basic chain, in which the gain and the lag bear the limit; or an interval
/// that many episodes make narrower than what is not known of when commands were sent.
TEST(ChainEpisodes, HaveTheSpeedLimitOfTheirLargeMotions) {
  std::mt19937 random(6);
  for (const double rate_hz : {50.0, 100.0}) {
    ChainEpisodes episodes;
    for (int e = 0; e < 12; ++e) {
      const double most_deg = e < 4 ? 10.0 : e < 8 ? 40.0 : 100.0;
      episodes.logs.push_back(LimitedSteps(most_deg, e % 4 < 2, 0.06, rate_hz, 0.0, random, 12.0));
    }
    const ChainFit fit = IdentifyChain(std::move(episodes)).fits[0];
    EXPECT_NEAR(fit.speed_limit_deg_s.value, 300.0, 5.0);
    EXPECT_LE(fit.dead_time_ms.low, 60.0) << rate_hz;
    EXPECT_GE(fit.dead_time_ms.high, 60.0) << rate_hz;
    EXPECT_NEAR(fit.gain.value, 1.0, 0.01);
    EXPECT_TRUE(std::isnan(fit.delay_ms.value));
    EXPECT_NEAR(fit.unlimited_delay_ms, 75.0 + 500.0 / rate_hz, 5.0);
    EXPECT_THAT(fit.remarks, testing::Contains(HasSubstr("depends on the size of the motion")));
  }
}

TEST(ChainEpisodes, GiveTheHandBackAndHoldForTheOthers) {
  ChainEpisodes episodes;
  for (int e = 0; e < 8; ++e) episodes.logs.push_back(MakeUpEpisode({}, e, e));
  const ChainResult result = IdentifyChain(std::move(episodes));
  EXPECT_EQ(result.fitted, 4U);
  EXPECT_EQ(result.judged, 4U);
  const ChainFit& fit = result.fits[0];
  EXPECT_NEAR(fit.gain.value, 0.95, 0.01);
  EXPECT_NEAR(fit.offset_deg.value, 2.0, 0.3);
  EXPECT_NEAR(fit.hysteresis_deg.value, 1.0, 0.2);
  EXPECT_NEAR(fit.dead_time_ms.value + fit.lag_ms.value, 100.0, 5.0);
  EXPECT_LT(fit.delay_ms.low, fit.delay_ms.value);
  EXPECT_GT(fit.delay_ms.high, fit.delay_ms.value);
  const HeldOutPart& part = result.held_out[0];
  EXPECT_NEAR(part.held_out_delay_ms.value, fit.delay_ms.value, 5.0);
  EXPECT_LT(part.held_out_rms_deg, 1.3 * part.fitted_rms_deg);
  EXPECT_LT(part.held_out_rms_deg, 0.2);
  EXPECT_TRUE(std::isnan(part.repeat_rms_deg));
}

/// Who judges on the fitted episodes does not see this.
TEST(ChainEpisodes, TellThatTheOthersAreOfAnotherHand) {
  ChainEpisodes episodes;
  for (int e = 0; e < 6; ++e) {
    episodes.logs.push_back(MakeUpEpisode({.lag_s = e % 2 == 0 ? 0.06 : 0.12}, e, e));
  }
  const ChainResult result = IdentifyChain(std::move(episodes));
  const HeldOutPart& part = result.held_out[0];
  EXPECT_NEAR(part.held_out_delay_ms.value - result.fits[0].delay_ms.value, 60.0, 10.0);
  EXPECT_GT(part.held_out_rms_deg, 3.0 * part.fitted_rms_deg);
  const std::string text = TextOf(HeldOutText(result), {});
  EXPECT_THAT(text, HasSubstr("differs by at most"));
  EXPECT_THAT(text, HasSubstr("No episodes repeat\nthe commands of others."));
}

TEST(ChainEpisodes, KnowWhatRepeatedMotionsLeave) {
  ChainEpisodes episodes;
  for (int e = 0; e < 4; ++e) {
    episodes.logs.push_back(MakeUpEpisode({.noise_deg = 0.4}, e / 2, e));  // each motion twice
  }
  const ChainResult result = IdentifyChain(std::move(episodes));
  EXPECT_NEAR(result.held_out[0].repeat_rms_deg, 0.4, 0.02);
  EXPECT_LT(result.held_out[0].held_out_rms_deg, 1.2 * result.held_out[0].repeat_rms_deg);
}

TEST(ChainEpisodes, CountOnlyWhereThePartMoves) {
  ChainEpisodes episodes;
  for (int e = 0; e < 5; ++e) episodes.logs.push_back(MakeUpEpisode({}, e, e));
  ChainLog& still = episodes.logs[2];
  still.command_deg = (0.05 * (still.command_deg.array() - 30.0)).matrix();
  still.angle_deg = (0.2 * still.angle_deg.array()).matrix();  // another gain
  episodes.logs[4] = MakeUpEpisode({}, 4, 4, 2.0);             // too short
  episodes.left_out = {"episode 9: cut"};
  const ChainResult result = IdentifyChain(std::move(episodes));
  EXPECT_EQ(result.held_out[0].fitted, 1U);
  EXPECT_NEAR(result.fits[0].gain.value, 0.95, 0.02);
  EXPECT_TRUE(std::isfinite(result.fits[0].gain.high));  // that of its one episode
  EXPECT_THAT(result.left_out,
              ElementsAre("episode 9: cut", HasSubstr("episode 4: joint: is 2 s")));
}

}  // namespace
}  // namespace gauntlet::sim
