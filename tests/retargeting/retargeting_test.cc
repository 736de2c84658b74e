#include "sim/fit/retarget/retargeting.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "sim/base/error.h"
#include "sim/base/random.h"
#include "tests/retargeting/motions.h"

namespace gauntlet::sim::testing {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

double DeepestOverlap(HandKinematics& hand, const MatrixXd& angle_rad) {
  double deepest_m = 0.0;
  for (Eigen::Index k = 0; k < angle_rad.rows(); ++k) {
    const VectorXd row = angle_rad.row(k);
    hand.SetAngles({row.data(), row.data() + row.size()});
    deepest_m = std::max(deepest_m, hand.Overlap());
  }
  return deepest_m;
}

TEST(Retarget, GivesBackTheAnglesOfTheSameHand) {
  for (const char* name : {"hand_arm.xml", "five_motor_hand.xml"}) {
    HandKinematics hand = ModelHand(name);
    const MatrixXd angles = SwingingAngles(hand, 200);
    const FingertipMotion motion = MotionOf(hand, angles);
    ASSERT_EQ(DeepestOverlap(hand, angles), 0.0);
    const RetargetedMotion retargeted = Retarget(motion, hand);
    ASSERT_EQ(std::ssize(retargeted.joints), angles.cols());
    const double worst_rad = (retargeted.angle_rad - angles).cwiseAbs().maxCoeff();
    EXPECT_LT(worst_rad * kDegPerRad, 0.5) << name;
    EXPECT_LT(*std::ranges::max_element(retargeted.tip_error_m[HandKinematics::kThumb]), 2e-4);
  }
}

/// The cost of RetargetingConfig's equation, written a second time.
double CostOf(HandKinematics& hand, const FingertipMotion& motion, const VectorXd& angles,
              const RetargetingConfig& config = {}) {
  const FingertipFrame& frame = motion.frames.front();
  hand.SetAngles({angles.data(), angles.data() + angles.size()});
  double own = 0.0;
  double recorded = 0.0;
  for (int finger = 0; finger < kFingers; ++finger) {
    own += hand.digits()[finger].length_m;
    recorded += motion.length_m[finger];
  }
  std::array<double, kFingers> blend = {};
  for (int finger = 1; finger < kFingers; ++finger) {
    const double share = (0.025 - frame.gap_m[finger]) / 0.020;
    blend[finger] = 0.7 * std::min(std::max(share, 0.0), 1.0);
    blend[0] = std::max(blend[0], blend[finger]);
  }
  double cost = 0.0;
  for (int finger = 0; finger < kFingers; ++finger) {
    const auto& digit = hand.digits()[finger];
    const Eigen::Vector3d wanted =
        digit.base_m + digit.length_m / motion.length_m[finger] * frame.reach_m[finger];
    const double length_m = config.direction_length_m;
    cost +=
        (1.0 - blend[finger]) *
        ((hand.Tip(finger) - wanted).squaredNorm() +
         length_m * length_m * (hand.TipDirection(finger) - frame.direction[finger]).squaredNorm());
    if (finger == 0 || blend[finger] == 0.0) continue;
    const double scale = own / recorded;
    const Eigen::Vector3d apart = hand.Tip(finger) - hand.Tip(0);
    const double gap_m = hand.PinchGap(finger)->gap_m;
    const double recorded_m = frame.gap_m[finger];
    const double wanted_m = std::max(
        recorded_m > 0.002 ? 0.002 + scale * (recorded_m - 0.002) : recorded_m, config.clearance_m);
    cost += blend[finger] * ((apart - scale * frame.from_thumb_m[finger]).squaredNorm() +
                             config.pinch_weight * std::pow(gap_m - wanted_m, 2));
  }
  std::vector<Digits::Gap> gaps;
  hand.FindGaps(config.clearance_m, gaps);
  for (const Digits::Gap& gap : gaps) {
    cost += config.overlap_weight * std::pow(config.clearance_m - gap.gap_m, 2);
  }
  return cost;
}

/// Pattern search: knows no derivatives.
double LeastCostFrom(HandKinematics& hand, const FingertipMotion& motion, VectorXd angles) {
  double least = CostOf(hand, motion, angles);
  for (double step = 0.2; step > 1e-3;) {
    bool is_better = false;
    for (Eigen::Index j = 0; j < angles.size(); ++j) {
      const HandJoint& joint = hand.joints()[static_cast<std::size_t>(j)];
      for (const double move : {-step, step}) {
        VectorXd moved = angles;
        moved[j] = std::clamp(moved[j] + move, joint.min_rad, joint.max_rad);
        const double cost = CostOf(hand, motion, moved);
        if (cost >= least) continue;
        least = cost;
        angles = moved;
        is_better = true;
      }
    }
    if (!is_better) step *= 0.5;
  }
  return least;
}

TEST(Retarget, NoOtherPostureCostsLess) {
  HandKinematics source = ModelHand("five_motor_hand.xml");
  HandKinematics hand = ModelHand("hand_arm.xml");
  RandomStream random(3, "postures");
  for (int i = 0; i < 4; ++i) {
    MatrixXd posture(1, std::ssize(source.joints()));
    for (Eigen::Index j = 0; j < posture.cols(); ++j) {
      const HandJoint& joint = source.joints()[static_cast<std::size_t>(j)];
      posture(0, j) = random.Uniform(joint.min_rad, joint.max_rad);
    }
    const FingertipMotion motion = MotionOf(source, posture);
    const RetargetedMotion retargeted = Retarget(motion, hand);
    const double cost = CostOf(hand, motion, retargeted.angle_rad.row(0));
    EXPECT_NEAR(retargeted.cost_m2.front(), cost, 1e-4 * cost);
    double least = LeastCostFrom(hand, motion, retargeted.angle_rad.row(0));
    for (int start = 0; start < 6; ++start) {
      VectorXd angles(std::ssize(hand.joints()));
      for (Eigen::Index j = 0; j < angles.size(); ++j) {
        const HandJoint& joint = hand.joints()[static_cast<std::size_t>(j)];
        angles[j] = random.Uniform(joint.min_rad, joint.max_rad);
      }
      least = std::min(least, LeastCostFrom(hand, motion, angles));
    }
    EXPECT_GT(least, 0.995 * cost) << i;
  }
}

/// Thumb and index of hand_arm.xml meet, from apart and back again.
MatrixXd PinchingAngles(const HandKinematics& hand, int rows) {
  MatrixXd angles(rows, std::ssize(hand.joints()));
  for (int k = 0; k < rows; ++k) {
    const double share = 0.5 - 0.5 * std::cos(2.0 * 3.14159265358979 * k / (rows - 1));
    for (Eigen::Index j = 0; j < angles.cols(); ++j) {
      const std::string& name = hand.joints()[static_cast<std::size_t>(j)].name;
      double deg = 0.0;
      if (name == "thumb_rotation") deg = 60.0 + 28.0 * share;
      if (name == "thumb_abduction") deg = 53.8;
      if (name == "thumb_mcp") deg = 4.1;
      if (name == "index_mcp") deg = 30.0 + 45.0 * share;
      if (name == "finger_spread") deg = 2.6;
      angles(k, j) = deg * kRadPerDeg;
    }
  }
  return angles;
}

TEST(Retarget, KeepsPinchesOfAHandWithOtherProportions) {
  HandKinematics hand = ModelHand("hand_arm.xml");
  for (const double size : {0.8, 1.0, 1.3}) {
    FingertipMotion motion = MotionOf(hand, PinchingAngles(hand, 200));
    double least_gap_m = 1.0;
    for (const FingertipFrame& frame : motion.frames) {
      least_gap_m = std::min(least_gap_m, frame.gap_m[HandKinematics::kIndex]);
    }
    for (FingertipFrame& frame : motion.frames) {
      for (int finger = 0; finger < kFingers; ++finger) {
        frame.gap_m[finger] = size * (frame.gap_m[finger] - least_gap_m);
        frame.from_thumb_m[finger] *= size;
        frame.reach_m[finger] *= size;
      }
      // Its thumb stands elsewhere: by reach alone the pinch would be open by millimetres.
      frame.reach_m[HandKinematics::kThumb] += size * Eigen::Vector3d(-0.004, 0.008, -0.004);
    }
    for (double& length_m : motion.length_m) length_m *= size;
    RetargetingConfig by_reach;
    by_reach.pinch_most = 0.0;
    const auto worst_gap_m = [&](const RetargetedMotion& retargeted) {
      const std::vector<double>& gaps = retargeted.pinch_gap_m[HandKinematics::kIndex];
      EXPECT_GT(gaps.size(), 5);
      return gaps.empty() ? 1.0 : *std::ranges::max_element(gaps);
    };
    EXPECT_LT(worst_gap_m(Retarget(motion, hand)), 0.002) << size;
    EXPECT_GT(worst_gap_m(Retarget(motion, hand, by_reach)), 0.003) << size;
  }
}

TEST(Retarget, KeepsDigitsApart) {
  HandKinematics hand = ModelHand("hand_arm.xml");
  MatrixXd angles = PinchingAngles(hand, 100);
  for (Eigen::Index j = 0; j < angles.cols(); ++j) {  // the thumb swings through the index finger
    const std::string& name = hand.joints()[static_cast<std::size_t>(j)].name;
    if (name == "index_mcp") angles.col(j).setConstant(80.0 * kRadPerDeg);
    if (name == "thumb_abduction") angles.col(j).setConstant(45.0 * kRadPerDeg);
  }
  ASSERT_GT(DeepestOverlap(hand, angles), 0.005);
  const RetargetedMotion retargeted = Retarget(MotionOf(hand, angles), hand);
  EXPECT_LT(*std::ranges::max_element(retargeted.overlap_m), 0.0005);
}

TEST(Retarget, MovesNoJointFasterThanAllowed) {
  HandKinematics hand = ModelHand("hand_arm.xml");
  MatrixXd angles = SwingingAngles(hand, 40);
  angles.bottomRows(20).rowwise() = SwingingAngles(hand, 120).row(110);  // a jump
  RetargetingConfig config;
  config.most_speed_rad_s = 5.0;
  const RetargetedMotion retargeted = Retarget(MotionOf(hand, angles), hand, config);
  const MatrixXd steps = retargeted.angle_rad.bottomRows(39) - retargeted.angle_rad.topRows(39);
  EXPECT_LE(steps.cwiseAbs().maxCoeff(), 5.0 / 100.0 + 1e-9);
  EXPECT_GT(retargeted.frames_at_most_speed, 0);
  EXPECT_NEAR(retargeted.fastest_rad_s, 5.0, 1e-6);
}

TEST(Retarget, FindsPosturesThatAreFarApart) {
  HandKinematics hand = ModelHand("hand_arm.xml");
  MatrixXd angles = SwingingAngles(hand, 200)({0, 60, 120, 199}, Eigen::all);
  for (Eigen::Index j = 0; j < angles.cols(); ++j) {  // a fist in between
    const std::string& name = hand.joints()[static_cast<std::size_t>(j)].name;
    if (name.ends_with("_mcp") && !name.starts_with("thumb")) angles(2, j) = 85.0 * kRadPerDeg;
    if (name.ends_with("_pip")) angles(2, j) = 95.0 * kRadPerDeg;
  }
  ASSERT_EQ(DeepestOverlap(hand, angles), 0.0);
  const RetargetedMotion retargeted = Retarget(MotionOf(hand, angles, 0.5), hand);
  EXPECT_LT((retargeted.angle_rad - angles).cwiseAbs().maxCoeff() * kDegPerRad, 0.5);
}

TEST(Retarget, StaysWithinRanges) {
  HandKinematics source = ModelHand("five_motor_hand.xml");
  HandKinematics hand = ModelHand("hand_arm.xml");
  FingertipMotion motion = MotionOf(source, SwingingAngles(source, 50));
  for (FingertipFrame& frame : motion.frames) {
    for (Eigen::Vector3d& reach_m : frame.reach_m) reach_m *= 1.5;  // longer than the digits
  }
  const RetargetedMotion retargeted = Retarget(motion, hand);
  for (std::size_t j = 0; j < retargeted.joints.size(); ++j) {
    const auto column = retargeted.angle_rad.col(static_cast<Eigen::Index>(j));
    EXPECT_GE(column.minCoeff(), hand.joints()[j].min_rad);
    EXPECT_LE(column.maxCoeff(), hand.joints()[j].max_rad);
  }
  EXPECT_GT(*std::ranges::max_element(retargeted.share_at_limit), 0.5);
}

TEST(Retarget, LeavesFramesWithMissingValuesEmpty) {
  HandKinematics hand = ModelHand("hand_arm.xml");
  FingertipMotion motion = MotionOf(hand, SwingingAngles(hand, 20));
  const MatrixXd whole = Retarget(motion, hand).angle_rad;
  motion.is_missing[0] = motion.is_missing[7] = true;
  const RetargetedMotion retargeted = Retarget(motion, hand);
  EXPECT_EQ(retargeted.frames, 18);
  for (const int row : {0, 7}) EXPECT_TRUE(retargeted.angle_rad.row(row).array().isNaN().all());
  EXPECT_LT((retargeted.angle_rad.row(19) - whole.row(19)).cwiseAbs().maxCoeff(), 1e-3);
}

TEST(Retarget, GivesTheSameBitsAgain) {
  HandKinematics source = ModelHand("five_motor_hand.xml");
  HandKinematics hand = ModelHand("hand_arm.xml");
  HandKinematics other = ModelHand("hand_arm.xml");
  const FingertipMotion motion = MotionOf(source, SwingingAngles(source, 30));
  EXPECT_EQ(Retarget(motion, hand).angle_rad, Retarget(motion, other).angle_rad);
}

TEST(Retarget, RefusesMotionsWithoutACommonFingertip) {
  HandKinematics hand = ModelHand("hand_arm.xml");
  FingertipMotion motion = MotionOf(hand, SwingingAngles(hand, 2));
  motion.has_digit.fill(false);
  EXPECT_THROW(Retarget(motion, hand), UserError);
}

}  // namespace
}  // namespace gauntlet::sim::testing
