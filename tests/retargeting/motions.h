#pragma once

#include <Eigen/Core>
#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include "sim/base/signal.h"
#include "sim/fit/retarget/fingertip_motion.h"
#include "sim/hand/hand_kinematics.h"
#include "sim/tables/name_words.h"
#include "tests/support/source_dir.h"

namespace gauntlet::sim::testing {

inline constexpr int kFingers = HandKinematics::kFingers;

inline HandKinematics ModelHand(const std::string& name) {
  return {std::filesystem::path(SourceDir()) / "models" / name, "--hand", FingerOfJointName};
}

/// The fingertips of a hand at these angles [rad, rows x joints].
inline FingertipMotion MotionOf(HandKinematics& hand, const Eigen::MatrixXd& angle_rad,
                                double rate_hz = 100.0) {
  FingertipMotion motion;
  motion.file = "test";
  motion.hand = hand.file();
  for (Eigen::Index row = 0; row < angle_rad.rows(); ++row) {
    const Eigen::VectorXd angles = angle_rad.row(row);
    hand.SetAngles({angles.data(), angles.data() + angles.size()});
    FingertipFrame frame;
    for (int finger = 0; finger < kFingers; ++finger) {
      frame.reach_m[finger] = hand.Tip(finger) - hand.digits()[finger].base_m;
      frame.direction[finger] = hand.TipDirection(finger);
      if (finger == HandKinematics::kThumb) continue;
      frame.from_thumb_m[finger] = hand.Tip(finger) - hand.Tip(HandKinematics::kThumb);
      frame.gap_m[finger] = GapOfPinch(hand, finger, 0.015);
    }
    motion.time_s.push_back(static_cast<double>(row) / rate_hz);
    motion.frames.push_back(frame);
    motion.is_missing.push_back(false);
  }
  motion.has_digit.fill(true);
  for (int finger = 0; finger < kFingers; ++finger) {
    motion.length_m[finger] = hand.digits()[finger].length_m;
  }
  return motion;
}

/// Angles [rad] of all joints that swing slowly within a part of their ranges, thumb away.
inline Eigen::MatrixXd SwingingAngles(const HandKinematics& hand, int rows) {
  Eigen::MatrixXd angles(rows, std::ssize(hand.joints()));
  for (Eigen::Index j = 0; j < angles.cols(); ++j) {
    const HandJoint& joint = hand.joints()[static_cast<std::size_t>(j)];
    const double range = joint.max_rad - joint.min_rad;
    double middle = 0.5;
    if (joint.name == "thumb_rotation") middle = 0.2;
    if (joint.name == "thumb_abduction") middle = 0.8;
    for (int k = 0; k < rows; ++k) {
      const double swing = 0.12 * std::sin(0.04 * k + 0.7 * static_cast<double>(j));
      angles(k, j) = joint.min_rad + range * (middle + swing);
    }
  }
  return angles;
}

}  // namespace gauntlet::sim::testing
