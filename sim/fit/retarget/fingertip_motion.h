#pragma once

#include <Eigen/Core>
#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "sim/hand/hand_kinematics.h"

namespace gauntlet::sim {

/// Fingertips of a hand at one moment, in the frame of HandKinematics; places [m].
struct FingertipFrame {
  std::array<Eigen::Vector3d, HandKinematics::kFingers> reach_m = {};       // from base to tip
  std::array<Eigen::Vector3d, HandKinematics::kFingers> direction = {};     // of the last phalanx
  std::array<Eigen::Vector3d, HandKinematics::kFingers> from_thumb_m = {};  // its tip to this one
  std::array<double, HandKinematics::kFingers> gap_m = {};  // between thumb and finger; 0: contact
};

/// Motion of the fingertips of one hand, and what the retargeting has to know of that hand.
struct FingertipMotion {
  std::string file;
  std::string hand;  // whose fingertips these are, for reports
  std::vector<double> time_s;
  std::vector<FingertipFrame> frames;
  std::vector<bool> is_missing;  // per frame: a value is missing
  std::array<bool, HandKinematics::kFingers> has_digit = {};
  std::array<double, HandKinematics::kFingers> length_m = {};  // base to tip along the joints
  std::vector<std::string> remarks;                            // assumptions and left-out columns
  /// Angles of FingertipFormat::copied that the recording has [rad], rows x names: arm and wrist.
  std::vector<std::string> other_joints;
  Eigen::MatrixXd other_angle_rad;
  /// Angles of the finger joints of the recorded hand [rad], rows x joints; none of keypoints.
  std::vector<std::string> joints;
  Eigen::MatrixXd angle_rad;
};

/// How a recording of fingertips is read.
struct FingertipFormat {
  double rate_hz = 0.0;        // of a file without times; 0: it has them
  std::string array = {};      // of a file with several, or a topic; empty: by size
  double touch_mm = 15.0;      // distance of two tips whose pads touch, where no shape tells it
  std::string side = {};       // left or right, of a file with keypoints of both hands
  std::string unit = {};       // deg or rad, of angles whose names have none; empty: not given
  std::string time_unit = {};  // of a column of numbers; empty: found, see TimeByName()
  std::vector<std::string> copied = {};  // joints of the other hand whose angles are copied
};

/// The gap between a thumb and a finger with capsules, else the distance of tips less `touch_m`.
double GapOfPinch(const HandKinematics& hand, int finger, double touch_m);

/// Fingertips of a recording of joint angles. Columns have names of the hand's joints, with _deg,
/// _rad or nothing behind them; nothing means degrees. A joint without a column stays at 0. A digit
/// none of whose joints is recorded has no fingertip here.
/// Errors: UserError if no column is a joint that moves a fingertip, or if columns without a unit
/// may be in radians.
FingertipMotion FingertipsOfAngles(const std::filesystem::path& recording, HandKinematics& hand,
                                   const FingertipFormat& format);

/// Fingertips of keypoints, with names and in units as of FindKeypoints() and PlaceHand(). Radii
/// of the tips (`thumb_tip_radius` ..) are distances to the skin; without them two pads touch where
/// the tips are `touch_mm` apart.
/// Errors: UserError if there are no keypoints of one hand; as of PlaceHand().
FingertipMotion FingertipsOfKeypoints(const std::filesystem::path& recording,
                                      const FingertipFormat& format);

}  // namespace gauntlet::sim
