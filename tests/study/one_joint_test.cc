// Rest, slow and fast are matters of each joint: one that moves says nothing of those that do not.
#include <gtest/gtest.h>

#include <cmath>
#include <string_view>

#include "sim/base/channels.h"
#include "sim/study/study_run.h"

namespace gauntlet::sim {
namespace {

/// Only index_mcp moves, by 135 deg of range: 0.118 x 135 deg x 2 pi 0.5 Hz is 50 deg/s at most.
Scenario OneJointAt50DegPerSecond() {
  Scenario scenario;
  scenario.name = "one_joint";
  scenario.question = "What do joints that hold still have to do with one that moves?";
  scenario.glove.motion.settings = SineConfig{
      .duration_s = 3.0, .frequency_hz = {0.5}, .range_percent = 23.6, .channels = {"index_mcp"}};
  scenario.controllers = {{.name = "raw", .calibration = {}, .config = {}}};
  return scenario;
}

Scores ScoresOf(const Scenario& scenario) {
  return RunStudy(PrepareStudy(scenario), StudyOptions{}).seeds[0].controllers[0].scores;
}

double Value(const std::vector<double>& values, std::string_view key) {
  return values[MetricIndex(key)];
}

TEST(OneMovingJoint, IsNeverFastBelowTheLimitAndTheOthersRest) {
  const Scores scores = ScoresOf(OneJointAt50DegPerSecond());
  const auto mover = static_cast<std::size_t>(ChannelIndex("index_mcp"));
  EXPECT_TRUE(std::isnan(Value(scores.summary, "fast_tracking_rmse_deg")));
  EXPECT_TRUE(std::isnan(Value(scores.summary, "fast_jitter_rms_deg")));
  for (std::size_t channel = 0; channel < GloveChannels().size(); ++channel) {
    const std::vector<double>& values = scores.channels[channel];
    const bool moves = channel == mover;
    EXPECT_TRUE(std::isnan(Value(values, "fast_tracking_rmse_deg"))) << channel;
    EXPECT_EQ(std::isnan(Value(values, "rest_tracking_rmse_deg")), moves) << channel;
    EXPECT_EQ(std::isnan(Value(values, "rest_jitter_deg")), moves) << channel;
    EXPECT_EQ(std::isnan(Value(values, "slow_tracking_rmse_deg")), !moves) << channel;
  }
}

TEST(OneMovingJoint, IsScoredAsItsLabelSays) {
  Scenario scenario = OneJointAt50DegPerSecond();
  scenario.glove.motion.label = "fast";
  const Scores scores = ScoresOf(scenario);
  EXPECT_FALSE(std::isnan(Value(scores.summary, "fast_tracking_rmse_deg")));
  EXPECT_TRUE(std::isnan(Value(scores.summary, "slow_tracking_rmse_deg")));
  EXPECT_TRUE(std::isnan(Value(scores.summary, "rest_jitter_deg")));
}

}  // namespace
}  // namespace gauntlet::sim
