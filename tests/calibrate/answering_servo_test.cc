#include "sim/calibrate/answering_servo.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "controller/calibration/robust_statistics.h"
#include "sim/calibrate/identified_servo.h"
#include "sim/calibrate/simulated_answer.h"
#include "sim/hand/hand_model.h"
#include "tests/controller/test_signal.h"

namespace gauntlet::sim {
namespace {

const std::vector<std::string> kJoints = {"thumb_ip",   "index_mcp",  "index_pip",
                                          "middle_mcp", "middle_pip", "wrist_flexion"};

/// Six sines of 0.1 to 1.2 Hz for each joint, in the middle of its range.
ChainLog Commands(std::uint64_t seed) {
  constexpr double kRate_hz = 200.0;
  constexpr Eigen::Index kRows = 2400;
  const controller::TendonTransmission hand = HandModel(HandConfig()).transmission();
  controller::TestNoise random(seed);
  ChainLog log;
  log.name = "made up";
  log.parts = kJoints;
  log.rate_hz = kRate_hz;
  log.command_deg = Signal(kRows, std::ssize(kJoints));
  for (Eigen::Index part = 0; part < std::ssize(kJoints); ++part) {
    const auto joint = std::ranges::find(hand.joint_names, kJoints[part]);
    const std::size_t i = joint - hand.joint_names.begin();
    log.command_deg.col(part).setConstant(hand.reference_angle_rad[i] * kDegPerRad);
    const double range_deg = (hand.joint_max_rad[i] - hand.joint_min_rad[i]) * kDegPerRad;
    for (int sine = 0; sine < 6; ++sine) {
      const double angular =
          2.0 * std::numbers::pi * 0.1 * std::pow(12.0, (sine + random.Uniform()) / 6.0);
      const double phase = 2.0 * std::numbers::pi * random.Uniform();
      for (Eigen::Index row = 0; row < kRows; ++row) {
        log.command_deg(row, part) += 0.07 * range_deg * std::sin(angular * row / kRate_hz + phase);
      }
    }
  }
  log.angle_deg = log.command_deg;
  return log;
}

ChainLog AnswerOf(const HandConfig& hand, const ChainLog& commands) {
  return SimulatedAnswer(commands, hand);
}

double Median(const std::vector<ChainFit>& fits, ChainEstimate ChainFit::*quantity) {
  std::vector<double> values;
  for (const ChainFit& fit : fits) {
    EXPECT_EQ(fit.problem + fit.split_problem, "");
    values.push_back((fit.*quantity).value);
  }
  return controller::MedianOf(values);
}

class AnsweringServoOf : public testing::TestWithParam<ServoSettings> {};

// A hand is simulated some eight times for each kind: all in all about 4 s.
TEST_P(AnsweringServoOf, HasTheHysteresisAndTheDelayOfTheHiddenOne) {
  HandConfig hidden;
  hidden.servo.settings = GetParam();
  const ChainLog log = AnswerOf(hidden, Commands(1));
  const std::vector<ChainFit> fits = FitChains(log);
  const auto first = UntriedServo(log, fits, HandModel(HandConfig()));
  ASSERT_TRUE(first);
  const auto trial = TryServos(log, fits, *first, HandConfig());
  ASSERT_TRUE(trial);
  // On commands that the search has not seen.
  const auto other_log = FitChains(AnswerOf(hidden, Commands(2)));
  const auto other = FitChains(AnswerOf(trial->servo.PutInto(HandConfig()), Commands(2)));
  for (const auto quantity : {&ChainFit::hysteresis_deg, &ChainFit::delay_ms}) {
    const double was = Median(fits, quantity);
    EXPECT_NEAR(Median(trial->fits, quantity), was, 0.1 * was);
    const double other_was = Median(other_log, quantity);
    EXPECT_NEAR(Median(other, quantity), other_was, 0.15 * other_was);
  }
}

INSTANTIATE_TEST_SUITE_P(Kinds, AnsweringServoOf,
                         testing::Values(RcAnalogServo{}, BusServo{}, DynamixelServo{}),
                         [](const auto& kind) {
                           return std::string(controller::KindName(kind.param));
                         });

TEST(AnsweringServo, IsNotTriedOnPartsThatTheHandDoesNotHave) {
  ChainLog log = AnswerOf(HandConfig(), Commands(1));
  const std::vector<ChainFit> fits = FitChains(log);
  for (std::string& part : log.parts) part = "claw_" + part;
  EXPECT_FALSE(TryServos(log, fits, {}, HandConfig()));
  EXPECT_NE(ServoSettingsText(log, fits, HandModel(HandConfig())).find("not tried"),
            std::string::npos);
}

TEST(SimulatedAnswer, FollowsWithoutDelayWhereAServoIsStiffAndNothingRubs) {
  HandConfig config;
  config.servo.settings = IdealServo{};
  config.servo.numbers().full_torque_error_deg = 1.5;
  config.cable.capstan_friction = 0.0;
  const ChainLog commands = Commands(3);
  const ChainLog answer = AnswerOf(config, commands);
  EXPECT_EQ(answer.parts, kJoints);
  EXPECT_EQ(answer.rate_hz, 200.0);
  ASSERT_EQ(answer.angle_deg.rows(), commands.command_deg.rows());
  EXPECT_LT((answer.command_deg - commands.command_deg).cwiseAbs().maxCoeff(), 1e-9);
  // A frame waits for 10 ms in the mean, the servo's damping is 9 ms.
  for (const ChainFit& fit : FitChains(answer)) EXPECT_NEAR(fit.delay_ms.value, 19.0, 6.0);
}

}  // namespace
}  // namespace gauntlet::sim
