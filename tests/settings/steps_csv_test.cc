#include "sim/settings/steps_csv.h"

#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <limits>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "controller/controller.h"
#include "controller/step_recorder.h"
#include "tests/controller/test_hand.h"

namespace gauntlet::sim {
namespace {

using controller::Controller;
using controller::GloveStatus;
using controller::StepRecorder;
using controller::Untrusted;

TEST(StepsCsv, HasTheStepsWithStatesAndReasonsAsNames) {
  controller::RobotConfig robot = {.controller = {},
                                   .glove = controller::PlainGlove(2),
                                   .hand = controller::CoupledHand(2),
                                   .joint_map = {},
                                   .timing = {.ticks_per_sample = 2, .event_period_ms = 3.0}};
  robot.glove.channel_names = {"joint_0", "tip, \"worn\""};
  robot.joint_map.joints = {{.joint = "joint_1", .channels = {"tip, \"worn\""}}};
  robot.controller.untrusted.lost_after_ms = 4.0;
  Controller controller(robot);
  controller.Reset(controller::HalfClosed(2));
  StepRecorder recorder(robot, 7);
  const auto step = [&](double first, double second, std::int64_t number) {
    const std::array counts = {first, second};
    const controller::GloveSample sample = {.counts = counts, .number = number};
    recorder.Add(sample, controller, controller.Step(sample));
  };
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  step(500.0, 500.0, 1);
  recorder.Add(controller, controller.Step());
  step(500.0, kInfinity, 2);
  recorder.Add(controller, controller.Step());
  step(0.1 + 0.2, 1023.0, 3);
  for (int k = 0; k < 3; ++k) recorder.Add(controller, controller.Step());
  std::vector<double> rows(7 * recorder.column_names().size());
  ASSERT_EQ(recorder.CopyTo(rows), 7);
  const std::string head =
      "tick,sample,frame_number,event,glove,counts.joint_0,\"counts.tip, \"\"worn\"\"\","
      "untrusted.joint_0,\"untrusted.tip, \"\"worn\"\"\",target_angle_rad.joint_0,"
      "target_angle_rad.joint_1,command_counts.motor_0,command_counts.motor_1\n";
  // 500 counts are 0.75 rad. The second channel is lost 4 ticks after its last trusted value; a
  // sample is overdue 3 ticks after the last one.
  EXPECT_EQ(StepsToCsv(recorder.column_names(), rows),
            head +
                "1,0,,0,good,,,,,0.75,0.75,587,617\n"
                "2,1,2,0,held,500,inf,,infinite,0.75,0.75,587,617\n"
                "3,0,,1,held,,,,,0.75,0.75,587,617\n"
                "4,1,3,0,lost,0.30000000000000004,1023,jumped,full_scale,0.75,0.75,587,617\n"
                "5,0,,0,lost,,,,,0.75,0.75,587,617\n"
                "6,0,,1,lost,,,,,0.75,0.75,587,617\n"
                "7,0,,0,lost,,,missing,missing,0.75,0.75,587,617\n");
  EXPECT_EQ(StepsToCsv(recorder.column_names(), {}), head);
}

TEST(StepsCsv, HasANameForEachStateAndEachReason) {
  std::set<std::string_view> names;
  for (int kind = 0; kind < controller::kUntrustedKinds; ++kind) {
    names.insert(NameOf(static_cast<Untrusted>(kind)));
  }
  for (const GloveStatus status :
       {GloveStatus::kGood, GloveStatus::kHeld, GloveStatus::kTooOften, GloveStatus::kLost}) {
    names.insert(NameOf(status));
  }
  EXPECT_EQ(names.size(), controller::kUntrustedKinds + 4);
  EXPECT_FALSE(names.contains(""));
}

}  // namespace
}  // namespace gauntlet::sim
