#include "sim/fit/answering_servo.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "controller/calibration/robust_statistics.h"
#include "sim/hand/hand_model.h"
#include "tests/calibrate/joint_commands.h"

namespace gauntlet::sim {
namespace {

// Most of the time goes into the fits of each joint, so few of them and short logs.
const std::vector<std::string> kJoints = {"thumb_ip", "index_mcp", "middle_pip", "wrist_flexion"};

ChainLog Commands(std::uint64_t seed) { return JointCommands(kJoints, 8.0, seed); }

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

// A hand is simulated some eight times for each kind.
TEST_P(AnsweringServoOf, HasTheHysteresisAndTheDelayOfTheHiddenOne) {
  HandConfig hidden;
  hidden.servo.settings = GetParam();
  const ChainLog log = AnswerOf(hidden, Commands(1));
  const std::vector<ChainFit> fits = FitChains(log, {}, ChainDetail::kBasic);
  const auto first = UntriedServo(log, fits, HandModel(HandConfig()));
  ASSERT_TRUE(first);
  const auto trial = TryServos(log, fits, *first, HandConfig());
  ASSERT_TRUE(trial);
  // On commands that the search has not seen.
  const auto other_log = FitChains(AnswerOf(hidden, Commands(2)), {}, ChainDetail::kBasic);
  const auto other =
      FitChains(AnswerOf(trial->servo.PutInto(HandConfig()), Commands(2)), {}, ChainDetail::kBasic);
  for (const auto quantity : {&ChainFit::hysteresis_deg, &ChainFit::delay_ms}) {
    const double was = Median(fits, quantity);
    EXPECT_NEAR(Median(trial->fits, quantity), was, 0.17 * was);
    const double other_was = Median(other_log, quantity);
    EXPECT_NEAR(Median(other, quantity), other_was, 0.19 * other_was);
  }
}

INSTANTIATE_TEST_SUITE_P(Kinds, AnsweringServoOf,
                         testing::Values(RcAnalogServo{}, BusServo{}, DynamixelServo{}),
                         [](const auto& kind) {
                           return std::string(controller::KindName(kind.param));
                         });

TEST(AnsweringServo, HasForEachMotorTheFrictionThatItsJointShows) {
  const std::vector<std::string> joints = {"thumb_ip", "index_mcp", "middle_mcp", "wrist_flexion"};
  HandConfig hidden;
  const HandModel usual(hidden);
  hidden.motor_friction_scale.assign(usual.motor_names().size(), 1.0);
  const auto place = [&](const std::string& motor) {
    return std::ranges::find(usual.motor_names(), motor) - usual.motor_names().begin();
  };
  hidden.motor_friction_scale[place("index_mcp")] = 1.6;
  hidden.motor_friction_scale[place("middle_mcp")] = 0.5;
  hidden.motor_friction_scale[place("thumb_ip")] = 0.4;
  const ChainLog log = AnswerOf(hidden, JointCommands(joints, 12.0, 1));
  const std::vector<ChainFit> fits = FitChains(log, {}, ChainDetail::kBasic);
  const auto trial = TryServos(log, fits, UntriedServo(log, fits, usual).value(), HandConfig());
  ASSERT_TRUE(trial);
  const auto other_log =
      FitChains(AnswerOf(hidden, JointCommands(joints, 12.0, 2)), {}, ChainDetail::kBasic);
  const auto other =
      FitChains(AnswerOf(trial->servo.PutInto(HandConfig()), JointCommands(joints, 12.0, 2)), {},
                ChainDetail::kBasic);
  const auto tells = [](const ChainFit& fit) {
    return fit.hysteresis_deg.low > 0.5 * fit.hysteresis_deg.value;
  };
  int told = 0;
  for (std::size_t i = 0; i < joints.size(); ++i) {
    if (!tells(fits[i])) continue;
    ++told;
    const double was_deg = fits[i].hysteresis_deg.value;
    EXPECT_NEAR(trial->fits[i].hysteresis_deg.value, was_deg, 0.15 * was_deg + 0.1) << joints[i];
    if (!tells(other_log[i])) continue;
    const double other_was_deg = other_log[i].hysteresis_deg.value;
    EXPECT_NEAR(other[i].hysteresis_deg.value, other_was_deg, 0.25 * other_was_deg + 0.2)
        << joints[i];
  }
  EXPECT_GE(told, 3);
  // Motors without a joint in the log have what is usual of the others, those of the arm their own.
  const std::vector<double>& found = trial->servo.motor_friction_scale;
  EXPECT_EQ(found[place("elbow_flexion")], 1.0);
  EXPECT_EQ(found[place("ring_mcp")], found[place("little_pip")]);
  EXPECT_LT(found[place("thumb_ip")], found[place("index_mcp")]);
}

TEST(AnsweringServo, IsNotTriedOnPartsThatTheHandDoesNotHave) {
  ChainLog log = AnswerOf(HandConfig(), JointCommands({"index_mcp"}, 8.0, 1));
  const std::vector<ChainFit> fits = FitChains(log, {}, ChainDetail::kBasic);
  for (std::string& part : log.parts) part = "claw_" + part;
  EXPECT_FALSE(TryServos(log, fits, {}, HandConfig()));
  EXPECT_NE(ServoSettingsText(log, HandModel(HandConfig())).find("not tried"), std::string::npos);
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
  for (const ChainFit& fit : FitChains(answer, {}, ChainDetail::kBasic))
    EXPECT_NEAR(fit.delay_ms.value, 19.0, 6.0);
}

}  // namespace
}  // namespace gauntlet::sim
