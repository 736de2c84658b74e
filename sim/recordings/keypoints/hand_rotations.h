#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "sim/recordings/keypoints/keypoint_angles.h"
#include "sim/recordings/keypoints/keypoint_layout.h"

namespace gauntlet::sim {

/// Quaternions of the bones of a hand at one moment, in the order of RotationColumns. NaN: none.
using HandRotations = Eigen::Matrix<double, 4, kTurnedBones>;

/// True if nearly all values are unit quaternions (norm within 2 % of 1), except in lost frames.
bool AreUnitQuaternions(const std::vector<HandRotations>& frames);

/// Angles of joints from rotations of bones.
struct AnglesOfBones {
  KeypointAngles angles;             // no residual
  std::vector<bool> is_lost;         // a bone is missing or no rotation, or all are repeated
  std::vector<std::string> remarks;  // for a person
};

/// Angles by these equations. r is the rotation of a bone relative to its parent, with a scalar
/// part of at least 0, h the axis about which the digit bends, in the frame of its bones.
///
///     r                  the quaternion of the file, or conj(parent) child of those in the world
///     h                  first eigenvector of the sum of rotation vectors rho rho^T, over the
///                        middle and distal bones of a finger, proximal and distal of a thumb
///     MCP, PIP, DIP, IP  2 atan2(vec(r) . h, r.w): the twist of r about h
///
/// The fingers bend more than they extend, so h points to flexion: its sign needs no handedness of
/// axes. The parent of a proximal bone is the metacarpal, or the hand where a file has none.
///
/// `local` or `world` in the names says what rotations are relative to. Without either, those with
/// names of OpenXR are relative to the world. Rotations of joints that are straight are assumed to
/// be equal.
///
/// Names of OpenXR, and an axis of bending along x within 15 deg, tell the other axes: b = -z (or
/// z, if h points to x) to the tip, y out of the back of the hand. l = y x b, with the sign that
/// puts the thumb on its side. Then, with t = b turned by the thumb's metacarpal relative to the
/// hand:
///
///     spread of a finger    a = 2 atan2(vec(s) . y, s.w), s = r conj(twist), towards the thumb
///     finger_spread         (a of the index finger - a of the little finger) / 2
///     thumb_abduction       acos(t . b)
///     thumb_rotation        atan2(-t . y, t . l), as AnglesOf() has it
///
/// Other files have no channels for these.
/// Sources: swing and twist, Dobrowolski, Swing-twist decomposition in Clifford algebra,
/// arXiv:1506.05481; axes, OpenXR 1.0, XR_EXT_hand_tracking.
/// Errors: UserError without a place if all frames are lost, the names do not say what rotations
/// are relative to, or the fingers do not bend about one axis each in the ranges of a finger.
AnglesOfBones AnglesOf(const std::vector<HandRotations>& frames, const KeypointColumns& columns);

}  // namespace gauntlet::sim
