#include "controller/tendon_map.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/controller/test_hand.h"
#include "tests/controller/test_signal.h"

namespace gauntlet::controller {
namespace {

TEST(TendonMap, GivesBackTheJointAngles) {
  const TendonTransmission hand = CoupledHand(18);
  TendonMap map(hand, true);
  TestNoise noise(5);
  std::vector<double> angle(18), exact(18), back(18);
  for (int trial = 0; trial < 100; ++trial) {
    for (double& value : angle) value = 0.2 + 0.5 * noise.Uniform();
    map.ToExactMotorCounts(angle, exact);
    map.ToJointAngles(std::span<const double>(exact), back);
    for (int i = 0; i < 18; ++i) EXPECT_NEAR(back[i], angle[i], 1e-12);
  }
}

TEST(TendonMap, LosesAtMostHalfACountByRounding) {
  const TendonTransmission hand = CoupledHand(18);
  TendonMap map(hand, true);
  TestNoise noise(6);
  std::vector<double> angle(18), exact(18);
  std::vector<std::int32_t> counts(18);
  for (int trial = 0; trial < 100; ++trial) {
    for (double& value : angle) value = 0.8 * noise.Uniform();
    map.ToExactMotorCounts(angle, exact);
    map.ToMotorCounts(angle, counts);
    for (int i = 0; i < 18; ++i) EXPECT_LE(std::abs(counts[i] - exact[i]), 0.5);
  }
}

TEST(TendonMap, MovesNeighboursOnlyWithoutCompensation) {
  const TendonTransmission hand = CoupledHand(4);
  std::vector<double> angle(4, 0.0), posture(4);
  angle[1] = 0.6;
  std::vector<double> counts(4);
  TendonMap compensated(hand, true);
  compensated.ToExactMotorCounts(angle, counts);
  compensated.ToJointAngles(std::span<const double>(counts), posture);
  EXPECT_NEAR(posture[2], 0.0, 1e-12);
  TendonMap dragging(hand, false);
  dragging.ToExactMotorCounts(angle, counts);
  dragging.ToJointAngles(std::span<const double>(counts), posture);
  // C = [1 ..; 0.4 1 ..]: joint 2 follows joint 1 by -0.4.
  EXPECT_NEAR(posture[1], 0.6, 1e-12);
  EXPECT_NEAR(posture[2], -0.24, 1e-12);
}

TEST(TendonMap, NeverLeavesTheRangeOfAMotor) {
  TendonTransmission hand = CoupledHand(6);
  hand.min_counts.assign(6, 400);
  hand.max_counts.assign(6, 600);
  TendonMap map(hand, true);
  TestNoise noise(7);
  std::vector<double> angle(6);
  std::vector<std::int32_t> counts(6);
  for (int trial = 0; trial < 2000; ++trial) {
    for (double& value : angle) value = std::pow(10.0, 20.0 * noise.Uniform()) * noise.Normal();
    if (trial % 3 == 0) angle[2] = std::numeric_limits<double>::quiet_NaN();
    if (trial % 5 == 0) angle[4] = -std::numeric_limits<double>::infinity();
    map.ToMotorCounts(angle, counts);
    for (const std::int32_t count : counts) {
      EXPECT_GE(count, 400);
      EXPECT_LE(count, 600);
    }
  }
}

TEST(TendonMap, ClampsJointsToTheirRange) {
  const TendonTransmission hand = CoupledHand(3);
  TendonMap map(hand, true);
  std::vector<std::int32_t> at_limit(3), beyond(3);
  map.ToMotorCounts(hand.joint_max_rad, at_limit);
  map.ToMotorCounts(std::vector<double>(3, 99.0), beyond);
  EXPECT_EQ(at_limit, beyond);
}

TEST(TendonMap, GivesBackOnlyTheJointsThatSpoolsDecide) {
  // Two motors, three joints: the second motor's cable bends the last two together.
  TendonTransmission hand = CoupledHand(3);
  hand.motor_names = {"first", "both"};
  hand.motor_of_joint = {"first", "both", "both"};
  hand.coupling = {1.0, 0.0, 0.0, 0.4, 0.8, 0.5};
  for (auto* values : {&hand.center_counts, &hand.min_counts, &hand.max_counts}) values->resize(2);
  hand.counts_per_rad.resize(2);
  TendonMap map(hand, true);
  std::vector<double> counts(2), posture(3);
  map.ToExactMotorCounts(std::vector<double>{0.3, 0.5, 0.7}, counts);
  EXPECT_NEAR(counts[0], 512.0 + 100.0 * 0.3, 1e-9);
  EXPECT_NEAR(counts[1], 512.0 + 100.0 * (0.4 * 0.3 + 0.8 * 0.5 + 0.5 * 0.7), 1e-9);
  map.ToJointAngles(std::span<const double>(counts), posture);
  EXPECT_NEAR(posture[0], 0.3, 1e-12);
  EXPECT_TRUE(std::isnan(posture[1]));
  EXPECT_TRUE(std::isnan(posture[2]));
  // Without compensation a cable that only passes a joint is not told of it.
  TendonMap(hand, false).ToExactMotorCounts(std::vector<double>{0.3, 0.5, 0.7}, counts);
  EXPECT_NEAR(counts[1], 512.0 + 100.0 * (0.8 * 0.5 + 0.5 * 0.7), 1e-9);
}

TEST(TendonMap, DecidesWithSpareMotorsByLeastSquares) {
  TendonTransmission hand = CoupledHand(2);
  hand.joint_names = {"only"};
  hand.motor_of_joint = {""};
  hand.coupling = {1.0, 2.0};
  for (auto* values : {&hand.reference_angle_rad, &hand.joint_min_rad, &hand.joint_max_rad}) {
    values->resize(1);
  }
  TendonMap map(hand, true);
  std::vector<double> posture(1);
  map.ToJointAngles(std::vector<double>{512.0 + 30.0, 512.0 + 60.0}, posture);
  EXPECT_NEAR(posture[0], 0.3, 1e-12);
}

TEST(TendonMap, RefusesShapesThatDoNotFitAndMotorsThatMoveNothing) {
  TendonTransmission hand = CoupledHand(2);
  hand.coupling = {1.0, 0.0, 0.4, 0.0};
  EXPECT_THROW(TendonMap(hand, true), SettingError);
  hand = CoupledHand(2);
  hand.max_counts.pop_back();
  EXPECT_THROW(TendonMap(hand, true), SettingError);
  hand = CoupledHand(2);
  hand.joint_names.push_back("one too many");
  EXPECT_THROW(TendonMap(hand, true), SettingError);
  hand = CoupledHand(2);
  hand.motor_of_joint = {"motor_0", "nobody"};
  EXPECT_THROW(TendonMap(hand, true), SettingError);
}

}  // namespace
}  // namespace gauntlet::controller
