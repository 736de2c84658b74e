// A trial whose hand diverges keeps its trace up to that moment.
#include <gtest/gtest.h>

#include "sim/trial/trial.h"
#include "tests/hand/small_hand.h"

namespace gauntlet::sim::testing {
namespace {

TEST(StoppedTrial, EndsWhereTheHandDivergedAndSaysSo) {
  GloveConfig config;
  config.channels = {"index_mcp"};
  config.motion.settings = HoldConfig{.duration_s = 0.5};
  const GloveSignal glove = SynthesiseGlove(config, 1);
  const Trace trace = RunTrial({.controller_name = "raw",
                                .controller = {},
                                .calibration = NominalCalibration(config),
                                .joint_map = {},
                                .hand = MakeDivergingHand("index_mcp")},
                               glove);
  EXPECT_FALSE(trace.health.ok);
  EXPECT_NE(trace.health.problem.find("at 0.0"), std::string::npos) << trace.health.problem;
  EXPECT_GT(trace.hand_angle_rad.rows(), 10);
  EXPECT_LT(trace.hand_angle_rad.rows(), 20);
  EXPECT_EQ(trace.tension_n.rows(), trace.hand_angle_rad.rows());
  EXPECT_EQ(trace.command_counts.rows(), trace.hand_angle_rad.rows());
}

}  // namespace
}  // namespace gauntlet::sim::testing
