// The loop: who gets what, and when.
#include "sim/trial/trial.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

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
  /// Frames of 20 ms with this delay.
  Trace Run(double event_delay_ms = 25.0, std::uint64_t seed = 1,
            const TrialOptions& options = {}) {
    glove_ = SynthesiseGlove(glove_config_, seed);
    hand_ = std::make_shared<const HandModel>(
        hand_config_, MakeLoopTiming({.sample_rate_hz = glove_config_.rate_hz,
                                      .event_delay_ms = event_delay_ms}));
    return RunTrial({.controller_name = "test",
                     .controller = controller_,
                     .calibration = NominalCalibration(glove_config_),
                     .joint_map = {},
                     .hand = hand_},
                    glove_, options);
  }

  GloveConfig glove_config_ = ShortRandomMotion();
  HandConfig hand_config_;
  controller::ControllerConfig controller_;
  GloveSignal glove_;
  std::shared_ptr<const HandModel> hand_;
};

TEST_F(TrialTest, FramesChangeOnlyAtEventsPlusDelay) {
  const Trace trace = Run(7.0);
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
  const Trace trace = Run(30.0);
  controller::Controller alone(controller_, NominalCalibration(glove_config_),
                               hand_->transmission());
  std::vector<std::int32_t> start(18);  // where the motors are until the first frame arrives
  for (int m = 0; m < 18; ++m) start[m] = static_cast<std::int32_t>(trace.command_counts(0, m));
  alone.Reset(start);
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
  EXPECT_NE(first.hand_angle_rad, Run(25.0, 2).hand_angle_rad);
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

TEST_F(TrialTest, RecordsWhatJointSensorsSaidWhereThereAreAny) {
  EXPECT_EQ(Run().measured_angle_rad.cols(), 0);
  hand_config_.joint_sensors = {.kind = JointSensorsKind::kEncoder,
                                .resolution_bits = 24,
                                .noise_deg = 0.0,
                                .rate_hz = 100.0,
                                .delay_ms = 5.0};
  const Trace trace = Run();
  ASSERT_EQ(trace.measured_angle_rad.cols(), 18);
  for (Eigen::Index k = 0; k < trace.hand_angle_rad.rows(); ++k) {
    const Eigen::Index read = (k - 5) / 10 * 10;  // at the beginning of this tick
    if (k < 5) {
      EXPECT_TRUE(trace.measured_angle_rad.row(k).array().isNaN().all()) << k;
    } else if (read > 0) {
      EXPECT_LT((trace.measured_angle_rad.row(k) - trace.hand_angle_rad.row(read - 1))
                    .cwiseAbs()
                    .maxCoeff(),
                1e-6)
          << k;
    }
  }
}

TEST_F(TrialTest, StopsWhenAsked) {
  EXPECT_THROW(Run(25.0, 1, {.keep_going = [] { return false; }}), Cancelled);
}

TEST_F(TrialTest, RecordsTheSignalsThatAreNamedAsIfAllWere) {
  const Trace all = Run();
  const Trace some = Run(25.0, 1, {.signals = {"tension_n", "motor_at_limit"}});
  EXPECT_EQ(some.tension_n, all.tension_n);
  EXPECT_EQ(some.motor_at_limit, all.motor_at_limit);
  EXPECT_EQ(some.hand_angle_rad.size(), 0);
  EXPECT_EQ(some.linearised_angle_rad.size(), 0);
  EXPECT_EQ(some.untrusted_samples, all.untrusted_samples);
  EXPECT_TRUE(some.health.ok);
  EXPECT_THROW(Run(25.0, 1, {.signals = {"tension"}}), std::invalid_argument);
}

TEST_F(TrialTest, HoldsTheSampleOfASlowGloveAndSendsFramesOnTheirOwnClock) {
  glove_config_.rate_hz = 33.3;
  const Trace trace = Run(0.0);
  EXPECT_EQ(glove_.ticks_per_sample, 31);
  EXPECT_EQ(trace.hand_angle_rad.rows(), glove_.true_angle_rad.rows());
  EXPECT_EQ(glove_.counts.rows(), (glove_.true_angle_rad.rows() + 30) / 31);
  const double ticks_per_frame = 20e-3 * glove_.tick_rate_hz;
  for (Eigen::Index k = 1; k < trace.hand_angle_rad.rows(); ++k) {
    const bool sampled = trace.linearised_angle_rad.row(k) != trace.linearised_angle_rad.row(k - 1);
    EXPECT_TRUE(!sampled || k % 31 == 0) << k;
    if (trace.command_counts.row(k) == trace.command_counts.row(k - 1)) continue;
    // The first tick at or after a multiple of 20 ms.
    const double frame = std::floor(static_cast<double>(k) / ticks_per_frame);
    EXPECT_EQ(static_cast<double>(k), std::ceil(frame * ticks_per_frame)) << k;
  }
}

}  // namespace
}  // namespace gauntlet::sim
