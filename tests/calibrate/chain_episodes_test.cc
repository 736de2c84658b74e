// A log of several episodes: what some say of the hand holds for the others, or it is told.
#include "sim/calibrate/chain_episodes.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "sim/base/normal_pair.h"
#include "sim/base/random.h"

namespace gauntlet::sim {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

/// A servo by its own equations: pure delay, lag of first order in steps of 1 ms, dead zone.
struct Plant {
  double dead_time_s = 0.04;
  double lag_s = 0.06;
  double gain = 0.95;
  double offset_deg = 2.0;
  double backlash_deg = 1.0;  // whole width
  double noise_deg = 0.05;
};

constexpr double kRowRate_hz = 100.0;

ChainLog Episode(const Plant& plant, int motion, int noise, double duration_s = 12.0) {
  RandomStream of_motion(static_cast<std::uint64_t>(motion), "motion");
  RandomStream of_noise(static_cast<std::uint64_t>(noise), "noise");
  std::vector<double> phase, frequency_hz;
  for (int i = 0; i < 4; ++i) {
    phase.push_back(2.0 * std::numbers::pi * of_motion.Uniform());
    frequency_hz.push_back(0.15 * (i + 1) * (0.8 + 0.4 * of_motion.Uniform()));
  }
  const auto command = [&](double t_s) {
    double sum = 30.0;
    for (int i = 0; i < 4; ++i) {
      sum += 12.0 / (i + 1) * std::sin(2.0 * std::numbers::pi * frequency_hz[i] * t_s + phase[i]);
    }
    return sum;
  };
  const auto rows = static_cast<Eigen::Index>(duration_s * kRowRate_hz);
  ChainLog log;
  log.name = "log";
  log.parts = {"joint"};
  log.rate_hz = kRowRate_hz;
  log.episode = motion;
  log.command_deg = log.angle_deg = Signal(rows, 1);
  double motor = plant.gain * command(-plant.dead_time_s), joint = motor;
  for (Eigen::Index row = 0; row < rows; ++row) {
    const double t_s = static_cast<double>(row) / kRowRate_hz;
    log.command_deg(row, 0) = command(t_s);
    log.angle_deg(row, 0) = joint + plant.offset_deg + plant.noise_deg * BoxMuller(of_noise).first;
    for (int step = 0; step < 10; ++step) {
      const double wanted = plant.gain * command(t_s + 1e-3 * step - plant.dead_time_s);
      motor += 1e-3 / plant.lag_s * (wanted - motor);
      joint = std::clamp(joint, motor - 0.5 * plant.backlash_deg, motor + 0.5 * plant.backlash_deg);
    }
  }
  return log;
}

TEST(ChainEpisodes, GiveTheHandBackAndHoldForTheOthers) {
  ChainEpisodes episodes;
  for (int e = 0; e < 8; ++e) episodes.logs.push_back(Episode({}, e, e));
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
    episodes.logs.push_back(Episode({.lag_s = e % 2 == 0 ? 0.06 : 0.12}, e, e));
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
    episodes.logs.push_back(Episode({.noise_deg = 0.4}, e / 2, e));  // each motion twice
  }
  const ChainResult result = IdentifyChain(std::move(episodes));
  EXPECT_NEAR(result.held_out[0].repeat_rms_deg, 0.4, 0.02);
  EXPECT_LT(result.held_out[0].held_out_rms_deg, 1.2 * result.held_out[0].repeat_rms_deg);
}

TEST(ChainEpisodes, CountOnlyWhereThePartMoves) {
  ChainEpisodes episodes;
  for (int e = 0; e < 5; ++e) episodes.logs.push_back(Episode({}, e, e));
  ChainLog& still = episodes.logs[2];
  still.command_deg = (0.05 * (still.command_deg.array() - 30.0)).matrix();
  still.angle_deg = (0.2 * still.angle_deg.array()).matrix();  // another gain
  episodes.logs[4] = Episode({}, 4, 4, 2.0);                   // too short
  episodes.left_out = {"episode 9: cut"};
  const ChainResult result = IdentifyChain(std::move(episodes));
  EXPECT_EQ(result.held_out[0].fitted, 1U);
  EXPECT_NEAR(result.fits[0].gain.value, 0.95, 0.02);
  EXPECT_TRUE(std::isfinite(result.fits[0].gain.high));  // that of its one episode
  EXPECT_THAT(result.left_out, ElementsAre("episode 9: cut", HasSubstr("episode 4: joint is 2 s")));
}

}  // namespace
}  // namespace gauntlet::sim
