#include "sim/hand/fingertips.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "sim/base/random.h"
#include "sim/tables/name_words.h"
#include "tests/retargeting/motions.h"

namespace gauntlet::sim::testing {
namespace {

std::shared_ptr<const HandModel> ModelOf(const std::string& file) {
  HandConfig config;
  config.model_path = std::string(SourceDir()) + "/models/" + file;
  return std::make_shared<const HandModel>(config);
}

/// Rows of random angles of a hand's joints within their ranges.
Signal RandomRows(const HandModel& hand, int rows, RandomStream& random) {
  Signal angle_rad(rows, std::ssize(hand.joints()));
  for (int row = 0; row < rows; ++row) {
    for (Eigen::Index joint = 0; joint < angle_rad.cols(); ++joint) {
      const HandJoint& of = hand.joints()[static_cast<std::size_t>(joint)];
      angle_rad(row, joint) = random.Uniform(of.min_rad, of.max_rad);
    }
  }
  return angle_rad;
}

// Two ways: the engine's kinematics, in the frame of HandKinematics, and chains from the palm. Both
// frames begin at the palm, so lengths and the tips' distances from each other are the same.
TEST(Fingertips, AreThoseOfTheEngineInAnyPosture) {
  for (const char* file : {"hand_arm.xml", "hand_arm_object.xml", "five_motor_hand.xml"}) {
    const auto hand = ModelOf(file);
    const auto tips = Fingertips::Of(*hand, FingerOfJointName);
    ASSERT_NE(tips, nullptr) << file;
    ASSERT_EQ(tips->names(),
              (std::vector<std::string>{"thumb", "index", "middle", "ring", "little"}));
    HandKinematics engine(*hand, FingerOfJointName);
    RandomStream random(4, "fingertips");
    const Signal angle_rad = RandomRows(*hand, 50, random);
    const Signal place_m = tips->Places(angle_rad, 1);
    ASSERT_EQ(place_m.cols(), 15);
    for (Eigen::Index row = 0; row < angle_rad.rows(); ++row) {
      std::vector<double> angles;
      for (const HandJoint& joint : engine.joints()) {
        const auto found = std::ranges::find(hand->joints(), joint.qpos, &HandJoint::qpos);
        ASSERT_NE(found, hand->joints().end()) << joint.name;
        angles.push_back(angle_rad(row, found - hand->joints().begin()));
      }
      engine.SetAngles(angles);
      for (int tip = 0; tip < kFingers; ++tip) {
        const Eigen::Vector3d place = place_m.row(row).segment<3>(3 * tip);
        EXPECT_NEAR(place.norm(), engine.Tip(tip).norm(), 1e-12) << file << " " << tip;
        const Eigen::Vector3d next = place_m.row(row).segment<3>(3 * ((tip + 1) % kFingers));
        const double apart_m = (engine.Tip((tip + 1) % kFingers) - engine.Tip(tip)).norm();
        EXPECT_NEAR((next - place).norm(), apart_m, 1e-12) << file << " " << tip;
      }
    }
  }
}

TEST(Fingertips, AreTakenEveryFewTicks) {
  const auto hand = ModelOf("hand_arm.xml");
  const auto tips = Fingertips::Of(*hand, FingerOfJointName);
  RandomStream random(5, "fingertips");
  const Signal angle_rad = RandomRows(*hand, 21, random);
  const Signal all = tips->Places(angle_rad, 1);
  const Signal some = tips->Places(angle_rad, 10);
  ASSERT_EQ(some.rows(), 3);
  for (int row = 0; row < 3; ++row) EXPECT_EQ(some.row(row), all.row(10 * row));
}

TEST(Fingertips, AreMovedByTheJointsOfTheirDigit) {
  const auto hand = ModelOf("hand_arm.xml");
  const auto tips = Fingertips::Of(*hand, FingerOfJointName);
  for (std::size_t joint = 0; joint < hand->joints().size(); ++joint) {
    const std::string& name = hand->joints()[joint].name;
    for (std::size_t tip = 0; tip < tips->names().size(); ++tip) {
      const std::string& finger = tips->names()[tip];
      const bool spreads = name == "finger_spread" && finger != "thumb" && finger != "middle";
      EXPECT_EQ(tips->Moves(static_cast<int>(joint), tip), name.starts_with(finger) || spreads)
          << name << " " << finger;
    }
  }
}

}  // namespace
}  // namespace gauntlet::sim::testing
