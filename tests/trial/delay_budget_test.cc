// Where the delay of the whole chain comes from: a noise-free sine of 1 Hz and 30 deg.
#include <gtest/gtest.h>

#include "sim/trial/trial.h"
#include "tests/hand/sine_delay.h"

namespace gauntlet::sim::testing {
namespace {

/// A wearer whose joint swings by 30 deg at 1 Hz, and a glove without any error but its counts.
GloveConfig Swing(const std::string& channel) {
  GloveConfig config;
  config.converter.bits = {16};
  config.noise.kind = WhiteNoiseKind::kNone;
  config.sensor.gain_deviation_percent = 0.0;
  config.sensor.offset_deviation_percent = 0.0;
  config.sensor.curvature_deviation_percent = 0.0;
  config.sensor.cross_talk_percent = 0.0;
  config.sensor.hysteresis_deg = 0.0;
  const Channel& joint = GloveChannels()[static_cast<std::size_t>(ChannelIndex(channel))];
  config.motion.settings =
      SineConfig{.duration_s = 4.0,
                 .frequency_hz = {1.0},
                 .range_percent = 100.0 * 60.0 / (joint.max_deg - joint.min_deg),
                 .channels = {channel}};
  return config;
}

/// Delay of a signal's third and fourth period behind sin(2 pi t) [ms].
template <class Column>
double DelayMs(const Column& signal, double time_of_row_0_s) {
  SineDelay delay;
  for (int k = 2000; k < 4000; ++k) {
    delay.Add(signal(k), 2.0 * std::numbers::pi * (k * 1e-3 + time_of_row_0_s));
  }
  return delay.Milliseconds();
}

// A frame leaves every 20 ms and is held until the next one: 10 ms on average, less half a sample.
TEST(DelayBudget, IsEventAndFrameAndServoAndLessThanTenMillisecondsOfCables) {
  HandConfig in_step;
  in_step.servo.settings = StandardServo{};
  in_step.arm_servo.settings = StandardServo{};
  for (const std::string name : {"index_mcp", "little_pip", "wrist_flexion", "elbow_flexion"}) {
    const GloveConfig config = Swing(name);
    const GloveSignal glove = SynthesiseGlove(config, 1);
    const int channel = ChannelIndex(name);
    for (double event_ms : {0.0, 45.0}) {
      const auto hand =
          std::make_shared<const HandModel>(in_step, MakeLoopTiming({.event_delay_ms = event_ms}));
      const Trace trace = RunTrial({.controller_name = "raw",
                                    .controller = {},
                                    .calibration = NominalCalibration(config),
                                    .joint_map = {},
                                    .hand = hand},
                                   glove);
      ASSERT_TRUE(trace.health.ok) << trace.health.problem;
      ASSERT_LT(std::abs(DelayMs(glove.true_angle_rad.col(channel), 0.0)), 0.1);
      // What the servos hold at row k acts until the end of the row; angles are those at its end.
      const double command =
          DelayMs(trace.command_counts.col(channel).cast<double>().array() -
                      static_cast<double>(hand->transmission().center_counts[channel]),
                  0.5e-3);
      const double spool = DelayMs(trace.spool_angle_rad.col(channel), 1e-3);
      const double joint = DelayMs(trace.hand_angle_rad.col(channel).array() -
                                       hand->transmission().reference_angle_rad[channel],
                                   1e-3);
      EXPECT_NEAR(command, event_ms + 10.0, 1.0) << name;
      const double servo = spool - command;
      EXPECT_GT(servo, 12.0) << name << ": its ratio of gains";
      EXPECT_LT(servo, 22.0) << name;
      EXPECT_NEAR(joint, event_ms + 10.0 + servo, 10.0) << name;
    }
  }
}

}  // namespace
}  // namespace gauntlet::sim::testing
