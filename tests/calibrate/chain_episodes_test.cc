// A log of several episodes: what some say of the hand holds for the others, or it is told.
#include "sim/fit/chain_episodes.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/calibrate/made_up_servo.h"

namespace gauntlet::sim {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

using test::MakeUpEpisode;

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
