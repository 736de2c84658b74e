// The servo of logs that the simulated servo made with other settings.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "sim/base/data_folder.h"
#include "sim/base/signal.h"
#include "sim/fit/answering_servo.h"
#include "sim/fit/chain_fit.h"
#include "tests/calibrate/made_up_servo.h"

namespace gauntlet::sim {
namespace {

HandConfig OneJoint() {
  HandConfig config;
  config.model_path = (DataFolder("models") / "one_joint.xml").string();
  return config;
}

/// What a hand answers to the commands of a motion.
ChainLog Answered(const HandConfig& hand, int motion) {
  const ChainLog commands = test::MakeUpEpisode({}, motion, 0, 8.0);
  return SimulatedAnswer(commands, hand);
}

double DelayOf(const ChainLog& log) {
  return FitChain(ColumnOf(log.command_deg, 0), ColumnOf(log.angle_deg, 0), log.rate_hz, 1, {},
                  ChainDetail::kDelay)
      .delay_ms.value;
}

double RmsBetween(const ChainLog& a, const ChainLog& b) {
  return std::sqrt((a.angle_deg - b.angle_deg).cwiseAbs2().mean());
}

AnsweringServo Usual() {
  return {.damping_ms = 12.0, .friction_scale = OneJoint().servo.numbers().friction_scale};
}

TEST(SearchServo, FindsTheServoFarFromWhereItBegins) {
  const std::vector<AnsweringServo> hidden = {{.dead_time_ms = 150.0,
                                               .damping_ms = 70.0,
                                               .full_torque_error_deg = 25.0,
                                               .friction_scale = 1.0,
                                               .motor_friction_scale = {2.0}},
                                              {.dead_time_ms = 60.0,
                                               .damping_ms = 20.0,
                                               .full_torque_error_deg = 60.0,
                                               .friction_scale = 1.0,
                                               .motor_friction_scale = {0.2}}};
  for (const AnsweringServo& servo : hidden) {
    SCOPED_TRACE(servo.dead_time_ms);
    const HandConfig hand = servo.PutInto(OneJoint());
    const auto found = SearchServo({Answered(hand, 1)}, Usual(), OneJoint());
    ASSERT_TRUE(found);
    // On commands that the search has not seen.
    const ChainLog wanted = Answered(hand, 3);
    const ChainLog answer = Answered(found->PutInto(OneJoint()), 3);
    EXPECT_NEAR(DelayOf(answer), DelayOf(wanted), 5.0);
    EXPECT_LT(RmsBetween(answer, wanted), 0.5)
        << found->damping_ms << " " << found->full_torque_error_deg;
  }
}

TEST(SearchServo, FindsNoneForAMotionThatTheCommandsDoNotCause) {
  ChainLog log = Answered(Usual().PutInto(OneJoint()), 1);
  log.angle_deg.col(0).reverseInPlace();
  EXPECT_FALSE(SearchServo({log}, Usual(), OneJoint()));
}

}  // namespace
}  // namespace gauntlet::sim
