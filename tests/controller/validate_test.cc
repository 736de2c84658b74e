#include "controller/validate.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "controller/controller.h"
#include "tests/controller/test_hand.h"

namespace gauntlet::controller {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

RobotConfig GoodRobot() {
  RobotConfig robot;
  robot.glove = PlainGlove(3);
  robot.hand = CoupledHand(3);
  robot.controller.filters = {{KalmanConfig{.noise = {.r = {15.0}, .q = {1e-4}}}}};
  return robot;
}

std::vector<std::string> LinesOf(const RobotConfig& robot) {
  std::vector<std::string> lines;
  for (const RobotProblem& problem : Validate(robot)) lines.push_back(TextOf(problem));
  return lines;
}

TEST(Validate, FindsNothingInAGoodRobot) { EXPECT_THAT(LinesOf(GoodRobot()), IsEmpty()); }

TEST(Validate, ListsAllProblemsAtOnce) {
  RobotConfig robot = GoodRobot();
  robot.glove.channel_names[1] = robot.glove.channel_names[0];
  robot.glove.high_angle_rad[2] = 60.0;
  robot.timing.event_period_ms = -1.0;
  robot.controller.motor.speed_limit_rad_s = -2.0;
  robot.joint_map.joints = {{.joint = "no_such_joint", .channels = {}}};
  const std::vector<std::string> lines = LinesOf(robot);
  EXPECT_THAT(lines, testing::Contains(HasSubstr("glove.channels." + robot.glove.channel_names[2] +
                                                 ".high_angle_rad: is 60")));
  EXPECT_THAT(lines, testing::Contains(HasSubstr("timing.event_period_ms: is -1")));
  EXPECT_THAT(lines, testing::Contains(HasSubstr("controller.motor.speed_limit_rad_s: is -2")));
  EXPECT_THAT(lines, testing::Contains(HasSubstr("glove.channel_names: ")));
  EXPECT_THAT(lines, testing::Contains(HasSubstr("no_such_joint")));
  EXPECT_THROW(Controller{robot}, SettingError);
}

TEST(Validate, WarnsOfAPoseFarBeyondItsJoint) {
  RobotConfig robot = GoodRobot();
  robot.glove.high_angle_rad[1] = 6.0;  // a Controller takes it
  const std::vector<RobotProblem> problems = Validate(robot);
  ASSERT_EQ(problems.size(), 1u);
  EXPECT_TRUE(problems[0].is_warning);
  EXPECT_EQ(problems[0].key, "glove.channels." + robot.glove.channel_names[1] + ".high_angle_rad");
  EXPECT_THAT(TextOf(problems[0]), HasSubstr("is it in degrees?"));
  EXPECT_NO_THROW(Controller{robot});
}

}  // namespace
}  // namespace gauntlet::controller
