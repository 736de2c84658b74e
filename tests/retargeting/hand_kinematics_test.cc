#include "sim/hand/hand_kinematics.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "sim/base/error.h"
#include "sim/base/random.h"
#include "sim/tables/name_words.h"
#include "tests/retargeting/motions.h"

namespace gauntlet::sim::testing {
namespace {

std::vector<double> RandomAngles(const HandKinematics& hand, RandomStream& random) {
  std::vector<double> angles;
  for (const HandJoint& joint : hand.joints()) {
    angles.push_back(random.Uniform(joint.min_rad, joint.max_rad));
  }
  return angles;
}

TEST(HandKinematics, PlacesFingertipsAsTheModelFileSays) {
  HandKinematics hand = ModelHand("hand_arm.xml");
  const auto& index = hand.digits()[HandKinematics::kIndex];
  // parts/index_knuckle.xml: spread axis, MCP, PIP, DIP, outer end of the last capsule.
  const Eigen::Vector3d knuckle(0.052 + 0.018, 0.030, 0.0);
  const Eigen::Vector3d tip = knuckle + Eigen::Vector3d(0.0426 + 0.0251 + 0.014, 0.0, 0.0002);
  // The axes follow the straight fingers, whose capsules end 0.2 mm above their joints.
  EXPECT_LT((index.base_m - knuckle).norm(), 5e-4);
  EXPECT_LT((hand.Tip(HandKinematics::kIndex) - tip).norm(), 5e-4);
  EXPECT_NEAR(index.tip_radius_m, 0.0054, 1e-9);
  EXPECT_NEAR(index.length_m, 0.0426 + 0.0251 + 0.014, 1e-5);
}

TEST(HandKinematics, FindsTheJointsThatMoveFingertips) {
  const HandKinematics hand = ModelHand("hand_arm.xml");
  EXPECT_EQ(hand.joints().size(), 13);  // 18 less wrist (2), forearm, elbow, shoulder
  for (std::size_t j = 0; j < hand.joints().size(); ++j) {
    const std::string& name = hand.joints()[j].name;
    for (int finger = 0; finger < kFingers; ++finger) {
      const bool own = name.starts_with(HandKinematics::kFingerNames[finger]);
      const bool spreads = name == "finger_spread" && finger != HandKinematics::kThumb &&
                           finger != HandKinematics::kMiddle;
      EXPECT_EQ(hand.Moves(j, finger), own || spreads) << name << " " << finger;
    }
  }
  EXPECT_EQ(hand.other_joint_names(),
            (std::vector<std::string>{"shoulder_flexion", "elbow_flexion", "forearm_rotation",
                                      "wrist_flexion", "wrist_deviation"}));
}

TEST(HandKinematics, FingersBendTowardsThePalm) {
  for (const char* name : {"hand_arm.xml", "five_motor_hand.xml"}) {
    HandKinematics hand = ModelHand(name);
    const double straight_m = hand.Tip(HandKinematics::kRing).z();
    std::vector<double> angles = hand.NeutralAngles();
    for (std::size_t j = 0; j < angles.size(); ++j) {
      if (hand.joints()[j].name == "ring_mcp") angles[j] = 0.5;
    }
    hand.SetAngles(angles);
    EXPECT_LT(hand.Tip(HandKinematics::kRing).z(), straight_m - 0.02);
  }
}

TEST(HandKinematics, DerivativesAreDifferences) {
  for (const char* name : {"hand_arm.xml", "five_motor_hand.xml"}) {
    HandKinematics hand = ModelHand(name);
    RandomStream random(1, "kinematics");
    for (int posture = 0; posture < 20; ++posture) {
      const std::vector<double> angles = RandomAngles(hand, random);
      hand.SetAngles(angles);
      std::array<Eigen::Matrix3Xd, kFingers> tip;
      std::array<Eigen::Matrix3Xd, kFingers> direction;
      for (int finger = 0; finger < kFingers; ++finger) {
        tip[finger] = hand.TipDerivative(finger);
        direction[finger] = hand.TipDirectionDerivative(finger);
      }
      const Eigen::RowVectorXd gap = hand.GapDerivative(*hand.PinchGap(HandKinematics::kMiddle));
      for (std::size_t j = 0; j < angles.size(); ++j) {
        constexpr double kStep = 1e-6;
        std::array<std::array<Eigen::Vector3d, 2 * kFingers>, 2> places;
        std::array<double, 2> gap_m = {};
        for (const int side : {0, 1}) {
          std::vector<double> moved = angles;
          moved[j] += side == 0 ? -kStep : kStep;
          hand.SetAngles(moved);
          for (int finger = 0; finger < kFingers; ++finger) {
            places[side][finger] = hand.Tip(finger);
            places[side][kFingers + finger] = hand.TipDirection(finger);
          }
          gap_m[side] = hand.PinchGap(HandKinematics::kMiddle)->gap_m;
        }
        const auto column = static_cast<Eigen::Index>(j);
        for (int finger = 0; finger < kFingers; ++finger) {
          const auto difference = [&](int i) -> Eigen::Vector3d {
            return (places[1][i] - places[0][i]) / (2.0 * kStep);
          };
          EXPECT_LT((tip[finger].col(column) - difference(finger)).norm(), 1e-7);
          EXPECT_LT((direction[finger].col(column) - difference(kFingers + finger)).norm(), 1e-6);
        }
        EXPECT_NEAR(gap[column], (gap_m[1] - gap_m[0]) / (2.0 * kStep), 1e-5);
      }
    }
  }
}

TEST(HandKinematics, RefusesAHandWithoutFingers) {
  const auto file = std::filesystem::path(SourceDir()) / "tests/support/three_joint_hand.xml";
  EXPECT_THROW(HandKinematics(file, "--hand", FingerOfJointName), UserError);
}

TEST(FingerOfJointName, KnowsNamesOfOtherHands) {
  for (const auto& [name, finger] : {std::pair{"FFJ3", "index"},
                                     {"rh_THJ4", "thumb"},
                                     {"if_mcp", "index"},
                                     {"lfj0", "little"},
                                     {"right_pinky_pip", "little"},
                                     {"R_ring_proximal_joint", "ring"},
                                     {"middle_mcp", "middle"},
                                     {"WRJ0", ""},
                                     {"elbow_flexion", ""}}) {
    EXPECT_EQ(FingerOfJointName(name), finger) << name;
  }
}

}  // namespace
}  // namespace gauntlet::sim::testing
