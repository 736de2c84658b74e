// The loop: who gets what, and when.
#include "sim/trial/trial.h"

#include <gtest/gtest.h>

#include <cmath>

#include "sim/base/channels.h"
#include "sim/base/error.h"

namespace gauntlet::sim {
namespace {

GloveConfig ShortRandomMotion() {
  GloveConfig config;
  config.motion.settings = RandomMotionConfig{.duration_s = 0.4};
  return config;
}

class TrialTest : public testing::Test {
 protected:
  Trace Run(const EventConfig& event = {}, std::uint64_t seed = 1) {
    glove_ = SynthesiseGlove(glove_config_, seed);
    return RunTrial("test", controller_, glove_, NominalCalibration(glove_config_), event, hand_);
  }

  GloveConfig glove_config_ = ShortRandomMotion();
  controller::ControllerConfig controller_;
  GloveSignal glove_;
  std::shared_ptr<const HandModel> hand_ =
      std::make_shared<const HandModel>(HandConfig{}, GloveChannelNames());
};

TEST_F(TrialTest, FramesChangeOnlyAtEventsPlusDelay) {
  const Trace trace = Run({.period_ms = 20, .delay_ms = 7});
  int changes = 0;
  for (Eigen::Index k = 1; k < trace.command_counts.rows(); ++k) {
    if ((trace.command_counts.row(k) - trace.command_counts.row(k - 1)).isZero()) continue;
    ++changes;
    EXPECT_EQ(k % 20, 7) << "sample " << k;
  }
  EXPECT_GT(changes, 10);
}

TEST_F(TrialTest, AFrameIsWhatTheControllerSaidOneDelayAgo) {
  // The controller alone, stepped by the test, must have given every frame at its event.
  const EventConfig event{.period_ms = 20, .delay_ms = 30};
  const Trace trace = Run(event);
  controller::Controller alone(controller_, NominalCalibration(glove_config_),
                               hand_->transmission());
  std::vector<double> counts(18);
  for (int k = 0; k + 30 < glove_.counts.rows(); ++k) {
    for (int c = 0; c < 18; ++c) counts[c] = glove_.counts(k, c);
    const controller::Command command = alone.Step({.counts = counts});
    if (k % 20 != 0) continue;
    for (int m = 0; m < 18; ++m) {
      ASSERT_EQ(trace.command_counts(k + 30, m), command.motor_counts[m]) << k << " " << m;
    }
  }
}

TEST_F(TrialTest, TwiceTheSameGivesTheSameBits) {
  const Trace first = Run();
  const Trace second = Run();
  EXPECT_EQ(first.hand_angle_rad, second.hand_angle_rad);
  EXPECT_EQ(first.tension_n, second.tension_n);
  EXPECT_NE(first.hand_angle_rad, Run({}, 2).hand_angle_rad);
}

TEST_F(TrialTest, EveryNumberIsFiniteAndTheHandIsWell) {
  const Trace trace = Run();
  EXPECT_TRUE(trace.health.ok) << trace.health.problem;
  EXPECT_EQ(trace.hand_angle_rad.rows(), glove_.counts.rows());
  EXPECT_TRUE(trace.hand_angle_rad.allFinite());
  EXPECT_TRUE(trace.filtered_angle_rad.allFinite());
  EXPECT_TRUE(trace.spool_speed_rad_s.allFinite());
  EXPECT_GE(trace.tension_n.minCoeff(), 0.0);
}

TEST_F(TrialTest, StopsWhenAsked) {
  glove_ = SynthesiseGlove(glove_config_, 1);
  EXPECT_THROW(RunTrial("test", controller_, glove_, NominalCalibration(glove_config_), {}, hand_,
                        [] { return false; }),
               Cancelled);
}

}  // namespace
}  // namespace gauntlet::sim
