// models/five_motor_hand.xml: what a prosthesis with one cable per digit has to do.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "sim/base/data_folder.h"
#include "tests/hand/hand_fixture.h"

namespace gauntlet::sim::testing {
namespace {

std::shared_ptr<const HandModel> FiveMotorHand() {
  HandConfig config;
  config.model_path = (DataFolder("models") / "five_motor_hand.xml").string();
  return MakeModel(config);
}

std::vector<double> AnglesOf(const Hand& hand) {
  std::vector<double> angle(hand.hand_model().joint_names().size());
  hand.ReadJointAngles(angle);
  return angle;
}

std::vector<std::int32_t> CountsToMove(const controller::TendonTransmission& map,
                                       const std::vector<double>& joint_rad) {
  const std::size_t joints = map.joint_names.size();
  std::vector<std::int32_t> counts;
  for (std::size_t motor = 0; motor < map.motor_names.size(); ++motor) {
    double spool = 0.0;
    for (std::size_t joint = 0; joint < joints; ++joint) {
      spool += map.coupling[motor * joints + joint] *
               (joint_rad[joint] - map.reference_angle_rad[joint]);
    }
    counts.push_back(static_cast<std::int32_t>(std::lround(map.ToCounts(motor, spool))));
  }
  return counts;
}

TEST(FiveMotorHand, HasFifteenJointsAndOneCablePerDigit) {
  const auto model = FiveMotorHand();
  EXPECT_THAT(model->motor_names(),
              ::testing::UnorderedElementsAre("index", "middle", "ring", "little", "thumb"));
  EXPECT_EQ(model->cable_names().size(), 5u);
  // Ten that cables move, and four end joints and the thumb's base that follow.
  EXPECT_EQ(model->joint_names().size(), 10u);
  EXPECT_EQ(model->model().njnt, 15 + 5);  // and a spool a motor
}

// Pulley over drum, whatever the posture: 8 and 6 mm over 9 mm, the thumb's 7 and 5.5 over 5 mm.
TEST(FiveMotorHand, SpoolsTurnByPulleyOverDrum) {
  const auto model = FiveMotorHand();
  const controller::TendonTransmission& map = model->transmission();
  for (std::size_t motor = 0; motor < map.motor_names.size(); ++motor) {
    for (std::size_t joint = 0; joint < map.joint_names.size(); ++joint) {
      const std::string& name = map.joint_names[joint];
      double expected = 0.0;
      if (name.starts_with(map.motor_names[motor] + "_")) {
        expected = name == "thumb_mcp"      ? 7.0 / 5.0
                   : name == "thumb_ip"     ? 5.5 / 5.0
                   : name.ends_with("_mcp") ? 8.0 / 9.0
                                            : 6.0 / 9.0;
      }
      EXPECT_NEAR(map.coupling[motor * map.joint_names.size() + joint], expected, 1e-6)
          << map.motor_names[motor] << " " << name;
    }
  }
}

TEST(FiveMotorHand, MotorsCloseAllJointsAndSpringsOpenThem) {
  Hand hand(FiveMotorHand());
  const controller::TendonTransmission& map = hand.hand_model().transmission();
  const std::vector<double> open(map.joint_names.size(), 0.0);
  const std::vector<double>& closed = map.joint_max_rad;
  std::vector<double> tension(hand.hand_model().cable_names().size());
  hand.Reset(open);
  for (const std::vector<double>* posture : {&closed, &open, &closed}) {
    hand.SetCommand(CountsToMove(map, *posture));
    StepTimes(hand, 1500);
    ASSERT_TRUE(hand.health().ok) << hand.health().problem;
    const std::vector<double> angle = AnglesOf(hand);
    for (std::size_t joint = 0; joint < angle.size(); ++joint) {
      EXPECT_NEAR(angle[joint], (*posture)[joint], 8.0 * kRadPerDeg) << map.joint_names[joint];
    }
    hand.ReadCableTensions(tension);
    EXPECT_GT(*std::ranges::min_element(tension), 0.5) << "a spring leaves its cable slack";
  }
}

}  // namespace
}  // namespace gauntlet::sim::testing
