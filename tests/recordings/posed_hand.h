#pragma once

#include <mujoco/mujoco.h>

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <map>
#include <memory>
#include <numbers>
#include <string>
#include <string_view>
#include <vector>

#include "sim/base/random.h"
#include "sim/base/signal.h"
#include "sim/hand/hand_model.h"
#include "sim/recordings/keypoints/keypoint_angles.h"
#include "sim/recordings/keypoints/keypoint_layout.h"

namespace gauntlet::sim::testing {

/// Angles [deg] of joints of models/hand_arm.xml at a frame: all move, each at its own speed.
inline std::map<std::string, double> AnglesAt(int frame) {
  const auto swing = [frame](double low, double high, double speed, double phase) {
    return low + (high - low) * (0.5 - 0.5 * std::cos(speed * frame + phase));
  };
  std::map<std::string, double> angles = {{"thumb_rotation", swing(15, 80, 0.031, 0.2)},
                                          {"thumb_abduction", swing(20, 50, 0.023, 1.0)},
                                          {"thumb_mcp", swing(5, 55, 0.053, 2.0)},
                                          {"thumb_ip", swing(-10, 70, 0.041, 0.0)},
                                          {"finger_spread", swing(0, 20, 0.019, 0.5)}};
  double phase = 0.0;
  for (const char* finger : {"index", "middle", "ring", "little"}) {
    const std::string name(finger);
    angles[name + "_mcp"] = swing(-25, 85, 0.061, phase);
    angles[name + "_pip"] = swing(0, 95, 0.071, phase);
    angles[name + "_dip"] = swing(0, 70, 0.067, phase + 0.3);
    phase += 0.35;
  }
  return angles;
}

/// Keypoints [m] of that hand, by the physics engine. Tips are 20 mm from the last joint.
class PosedHand {
 public:
  PosedHand() : data_(mj_makeData(&hand_.model()), &mj_deleteData) {}

  HandPoints PointsAt(const std::map<std::string, double>& angle_deg) {
    Pose(angle_deg);
    HandPoints points;
    points.col(0) = Anchor("wrist_flexion");
    points.col(1) = Anchor("thumb_abduction");
    points.col(2) = Anchor("thumb_mcp");
    points.col(3) = Anchor("thumb_ip");
    points.col(4) = points.col(3) + 0.02 * AlongBody("thumb_distal");
    int column = 5;
    for (const char* finger : {"index", "middle", "ring", "little"}) {
      for (const char* joint : {"_mcp", "_pip", "_dip"}) {
        points.col(column++) = Anchor(std::string(finger) + joint);
      }
      points.col(column) =
          points.col(column - 1) + 0.02 * AlongBody(std::string(finger) + "_distal");
      ++column;
    }
    return points;
  }

  /// Rotations of the bodies in the world, by bone: hand, and per digit metacarpal, proximal,
  /// middle and distal. x is along the bone, z out of the back of the hand. The metacarpals of
  /// fingers are the palm; the thumb has no middle bone.
  std::array<Eigen::Matrix3d, kTurnedBones> RotationsAt(
      const std::map<std::string, double>& angle_deg) {
    Pose(angle_deg);
    std::array<Eigen::Matrix3d, kTurnedBones> rotations;
    rotations.fill(BodyAxes("palm"));
    int digit = 0;
    for (const std::string finger : {"thumb", "index", "middle", "ring", "little"}) {
      const auto set = [&](int bone, const std::string& body) {
        rotations[static_cast<std::size_t>(TurnedBone(digit, bone))] = BodyAxes(finger + body);
      };
      if (digit == 0) set(0, "_metacarpal");
      set(1, "_proximal");
      if (digit > 0) set(2, "_middle");
      set(3, "_distal");
      ++digit;
    }
    return rotations;
  }

 private:
  void Pose(const std::map<std::string, double>& angle_deg) {
    mj_resetData(&hand_.model(), data_.get());
    for (const auto& [joint, angle] : angle_deg) Set(joint, angle);
    const double spread_deg = angle_deg.at("finger_spread");
    Set("ring_spread", -0.6 * spread_deg);
    Set("little_spread", -spread_deg);
    mj_kinematics(&hand_.model(), data_.get());
  }
  int JointId(const std::string& name) const {
    return mj_name2id(&hand_.model(), mjOBJ_JOINT, name.c_str());
  }
  void Set(const std::string& joint, double angle_deg) {
    data_->qpos[hand_.model().jnt_qposadr[JointId(joint)]] = angle_deg * kRadPerDeg;
  }
  Eigen::Vector3d Anchor(const std::string& joint) const {
    return Eigen::Vector3d::Map(data_->xanchor + 3 * JointId(joint));
  }
  Eigen::Matrix3d BodyAxes(const std::string& body) const {
    const double* axes = data_->xmat + 9 * mj_name2id(&hand_.model(), mjOBJ_BODY, body.c_str());
    return Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(axes);
  }
  Eigen::Vector3d AlongBody(const std::string& body) const { return BodyAxes(body).col(0); }

  HandModel hand_{HandConfig()};
  std::unique_ptr<mjData, void (*)(mjData*)> data_;
};

/// How a tracker sees the hand.
struct Tracker {
  double unit = 1.0;  // per m
  bool is_mirrored = false;
  double turn_rad = 0.0;  // per frame
  double noise_m = 0.0;   // standard deviation per coordinate
};

inline std::vector<HandPoints> TrackedPoints(int frames, const Tracker& tracker = {}) {
  PosedHand hand;
  RandomStream random(7, "tracker");
  const auto normal = [&random] {
    return std::sqrt(-2.0 * std::log(random.UniformAboveZero())) *
           std::cos(2.0 * std::numbers::pi * random.Uniform());
  };
  std::vector<HandPoints> all;
  for (int k = 0; k < frames; ++k) {
    HandPoints points = hand.PointsAt(AnglesAt(k));
    for (double& value : points.reshaped()) value += tracker.noise_m * normal();
    if (tracker.is_mirrored) points.row(1) *= -1.0;
    const Eigen::Matrix3d turn =
        Eigen::AngleAxisd(tracker.turn_rad * k, Eigen::Vector3d(1, 2, 3).normalized())
            .toRotationMatrix();
    points = tracker.unit * (turn * points).eval();
    all.push_back(points.colwise() + tracker.unit * Eigen::Vector3d(0.1, 0.9, -0.3 + 0.001 * k));
  }
  return all;
}

}  // namespace gauntlet::sim::testing
