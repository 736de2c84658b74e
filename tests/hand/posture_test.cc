#include <gmock/gmock.h>

#include <algorithm>

#include "sim/hand/mujoco_versions.h"
#include "tests/hand/hand_fixture.h"

namespace gauntlet::sim::testing {
namespace {

/// Largest distance from the goal over all channels after the hand had time to go there [deg].
double ErrorAfterSettling(Hand& hand, const std::vector<double>& start,
                          const std::vector<double>& goal) {
  hand.Reset(start);
  hand.SetCommand(CountsFor(hand.hand_model().transmission(), goal));
  StepTimes(hand, 1100);
  EXPECT_TRUE(hand.health().ok) << hand.health().problem;
  const std::vector<double> reached = JointAngles(hand);
  double worst = 0.0;
  for (std::size_t i = 0; i < goal.size(); ++i) {
    worst = std::max(worst, std::abs(reached[i] - goal[i]) * kDegPerRad);
  }
  return worst;
}

double WorstOverChannels(const HandConfig& config) {
  Hand hand(MakeModel(config));
  const controller::TendonTransmission& map = hand.hand_model().transmission();
  double worst = 0.0;
  for (std::size_t channel = 0; channel < map.joint_names.size(); ++channel) {
    for (double end : {map.joint_min_rad[channel], map.joint_max_rad[channel]}) {
      std::vector<double> goal = HomePosture(map);
      goal[channel] = end;
      worst = std::max(worst, ErrorAfterSettling(hand, HomePosture(map), goal));
    }
  }
  return worst;
}

// Without friction only gravity on elastic cables and servos is left.
TEST(Posture, EveryChannelReachesBothEndsWithinOneDegreeWithoutFriction) {
  EXPECT_LT(WorstOverChannels(FrictionFree()), 1.0);
}

// With capstan friction, dead band and 10-bit commands, the other channels' errors included.
TEST(Posture, EveryChannelReachesBothEndsWithinTwoDegreesWithFriction) {
  EXPECT_LT(WorstOverChannels(StiffServos()), 2.0);
}

TEST(Posture, AllChannelsTogetherReachRandomPostures) {
  Hand hand(MakeModel(StiffServos()));
  const controller::TendonTransmission& map = hand.hand_model().transmission();
  RandomStream random(1, "postures");
  for (int i = 0; i < 12; ++i) {
    const std::vector<double> goal = RandomPosture(map, random);
    EXPECT_LT(ErrorAfterSettling(hand, HomePosture(map), goal), 2.5) << "posture " << i;
  }
}

TEST(Posture, ResetStartsInThePostureAndKeepsIt) {
  Hand hand(MakeModel(StiffServos()));
  const controller::TendonTransmission& map = hand.hand_model().transmission();
  const std::vector<double> start = HomePosture(map);
  hand.Reset(start);
  EXPECT_EQ(JointAngles(hand), start);
  StepTimes(hand, 500);
  const std::vector<double> later = JointAngles(hand);
  for (std::size_t i = 0; i < start.size(); ++i) {
    EXPECT_NEAR(later[i] * kDegPerRad, start[i] * kDegPerRad, 1.0) << map.joint_names[i];
  }
}

TEST(Posture, ResetClampsToTheRanges) {
  Hand hand(MakeModel());
  const controller::TendonTransmission& map = hand.hand_model().transmission();
  hand.Reset(std::vector<double>(map.joint_names.size(), 100.0));
  EXPECT_EQ(JointAngles(hand), map.joint_max_rad);
}

// The drawing of a recorded posture must show what was simulated.
TEST(Posture, SetPostureAgreesWithTheSimulatedHand) {
  const auto model = MakeModel();
  Hand hand(model);
  const controller::TendonTransmission& map = model->transmission();
  RandomStream random(2, "postures");
  hand.SetCommand(CountsFor(map, RandomPosture(map, random)));
  StepTimes(hand, 700);
  std::vector<double> spool(map.motor_names.size());
  hand.ReadSpoolAngles(spool);

  std::unique_ptr<mjData, void (*)(mjData*)> drawn(mj_makeData(&model->model()), &mj_deleteData);
  SetPosture(*model, JointAngles(hand), spool, *drawn);
  int compared = 0;
  for (int body = 1; body < model->model().nbody; ++body) {
    const int simulated = model->physics().BodyOf(body);
    for (int axis = 0; axis < 3 && simulated >= 0; ++axis) {
      ++compared;
      EXPECT_NEAR(drawn->xpos[3 * body + axis], hand.data().xpos[3 * simulated + axis], 2e-4)
          << mj_id2name(&model->model(), mjOBJ_BODY, body);
    }
  }
  const int cut = kModelsCanBeCut ? 18 : 0;
  EXPECT_EQ(compared, 3 * (model->model().nbody - 1 - cut)) << "all but the spools";
}

TEST(Posture, RangesAreThoseOfTheGlove) {
  const controller::TendonTransmission map = MakeModel()->transmission();
  for (std::size_t i = 0; i < map.joint_names.size(); ++i) {
    EXPECT_NEAR(map.joint_min_rad[i] * kDegPerRad, GloveChannels()[i].min_deg, 1e-9);
    EXPECT_NEAR(map.joint_max_rad[i] * kDegPerRad, GloveChannels()[i].max_deg, 1e-9);
  }
}

}  // namespace
}  // namespace gauntlet::sim::testing
