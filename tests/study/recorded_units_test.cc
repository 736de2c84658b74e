#include "sim/study/recorded_units.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <fstream>
#include <numbers>
#include <string>
#include <vector>

#include "controller/controller.h"
#include "controller/validate.h"
#include "sim/base/channels.h"
#include "sim/base/signal.h"
#include "sim/glove/glove.h"
#include "sim/glove/motions/recorded_motion.h"
#include "tests/controller/test_hand.h"
#include "tests/support/program.h"

namespace gauntlet::sim {
namespace {

using controller::FilterConfig;

/// A recording with three columns of angles, and the robot of its trials, which takes counts.
class RecordedUnitsTest : public testing::TestWithParam<FilterConfig> {
 protected:
  RecordedUnitsTest() {
    const std::string file = (folder_.path() / "glove.csv").string();
    const std::string map = (folder_.path() / "map.csv").string();
    std::ofstream(file) << "t,a,b,c\n0,-20,0.3,0.5\n0.01,-21,0.4,0.6\n";
    std::ofstream(map) << "column,channel,unit,sign,scale\nt,time,s,,\na,index_mcp,deg,-1,\n"
                          "b,index_pip,rad,,\nc,middle_pip,share,,0.5\n";
    glove_.rate_hz = 100.0;
    glove_.channels = {"index_mcp", "index_pip", "middle_pip"};
    glove_.motion.settings =
        RecordedMotionConfig{.file = file, .map = map, .use = RecordingUse::kMeasured};
    robot_.glove = NominalCalibration(glove_);
    robot_.hand = controller::CoupledHand(3);
    robot_.hand.joint_names = glove_.channels;
    robot_.hand.motor_of_joint = {};
    robot_.timing = {.tick_rate_hz = 1000.0, .ticks_per_sample = 10};
  }

  test::TemporaryDirectory folder_;
  GloveConfig glove_;
  controller::RobotConfig robot_;
};

TEST_P(RecordedUnitsTest, GiveTheCommandsOfTheTrials) {
  robot_.controller.filters = {GetParam()};
  controller::RobotConfig robot = robot_;
  EXPECT_EQ(UseRecordedUnits(glove_, robot).units,
            "a sample of the glove is: radians (index_pip); the numbers of its column in the "
            "recording (index_mcp, middle_pip)");
  controller::Controller of_counts(robot_);
  controller::Controller of_angles(robot);
  std::vector<double> counts(3), angles(3);
  int moved = 0;
  for (int k = 0; k < 600; ++k) {
    const double share = 0.5 - 0.4 * std::cos(0.03 * k) + 0.02 * std::sin(2.1 * k * k);
    for (std::size_t i = 0; i < 3; ++i) {
      counts[i] = 102.3 + 818.4 * share;
      const Channel& joint = KnownChannels()[ChannelIndex(glove_.channels[i])];
      const double deg = joint.min_deg + share * (joint.max_deg - joint.min_deg);
      angles[i] = i == 0 ? -deg : i == 1 ? deg * kRadPerDeg : 2.0 * share;
    }
    for (int tick = 0; tick < 10; ++tick) {
      const auto a = tick == 0 ? of_counts.Step({.counts = counts}) : of_counts.Step();
      const auto b = tick == 0 ? of_angles.Step({.counts = angles}) : of_angles.Step();
      ASSERT_EQ(a.glove, b.glove) << k;
      for (std::size_t m = 0; m < a.motor_counts.size(); ++m) {
        // The first covariance of a Kalman filter is one for all units.
        ASSERT_NEAR(a.motor_counts[m], b.motor_counts[m], k < 100 ? 5 : 1) << k;
        moved += a.motor_counts[m] != robot_.hand.center_counts[m] ? 1 : 0;
      }
    }
  }
  EXPECT_GT(moved, 1000);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(of_angles.untrusted_samples()[i], 0);
}

const controller::KalmanNoise kNoise = {.r = {15.0}, .q = {1e-2}};
INSTANTIATE_TEST_SUITE_P(
    Filters, RecordedUnitsTest,
    testing::Values(FilterConfig{controller::NoFilterConfig{}},
                    FilterConfig{controller::KalmanConfig{.noise = kNoise}},
                    FilterConfig{.settings = controller::KalmanConfig{.noise = kNoise},
                                 .channels = {"middle_pip", "1"}},
                    FilterConfig{controller::KalmanSteadyConfig{.noise = kNoise}},
                    FilterConfig{controller::KalmanAdaptiveConfig{.noise = kNoise}},
                    FilterConfig{controller::KalmanDenseConfig{
                        .r = {15.0, 2.0, 0.0, 2.0, 15.0, 0.0, 0.0, 0.0, 9.0}, .q = {1e-2}}},
                    FilterConfig{controller::FixedLagConfig{.noise = kNoise}},
                    FilterConfig{controller::OneEuroConfig{.min_cutoff_hz = 1.0, .beta = 0.03}},
                    FilterConfig{.settings = controller::OneEuroConfig{},
                                 .per_channel = {{"beta", {0.01, 0.02, 0.03}}}},
                    FilterConfig{controller::JerkLimitConfig{}},
                    FilterConfig{controller::HampelConfig{}},
                    FilterConfig{controller::ButterworthConfig{}}));

TEST_F(RecordedUnitsTest, StayCountsWhereTheGloveGivesCounts) {
  std::get<RecordedMotionConfig>(glove_.motion.settings).use = RecordingUse::kTruth;
  controller::RobotConfig robot = robot_;
  EXPECT_EQ(UseRecordedUnits(glove_, robot).units, "");
  EXPECT_EQ(robot.glove.low_counts, robot_.glove.low_counts);
}

}  // namespace
}  // namespace gauntlet::sim
