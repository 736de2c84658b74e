#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "sim/recordings/keypoints/keypoint_layout.h"

namespace gauntlet::sim {

/// Positions of the keypoints of a hand at one moment. NaN: lost.
using HandPoints = Eigen::Matrix<double, 3, kKeypoints>;

/// Keypoints of a recording in the frame of the hand, in metres: origin in the wrist, x to the
/// middle of the knuckles of index and little finger, y to the thumb's side, z out of the back of
/// the hand. A left hand has the numbers of its mirror image.
struct PlacedHand {
  std::vector<HandPoints> points_m;
  std::vector<bool> is_lost;  // per frame: a point is missing, all are the same, or repeated
  std::size_t lost = 0;
  std::size_t implausible = 0;  // frames with a bone 25 % longer or shorter than usual
  double bone_spread = 0.0;     // median over bones of the relative deviation of their lengths
  double length_m = 0.0;        // from the wrist along the joints to the tip of the middle finger
  std::string_view unit = {};   // of the file: m, cm or mm
  bool is_left = false;         // by the side to which the fingers bend
};

/// Marks frames that repeat the one before for more than 5 frames, as a tracker does that has lost
/// the hand. `has_same(k)` says whether frame k has the values of frame k - 1; k > 0.
void MarkRepeats(const std::function<bool(std::size_t)>& has_same, std::vector<bool>& is_lost);

/// Finds the unit by the size of the hand, 0.10 to 0.30 m from the wrist to the tip of the middle
/// finger, unless `unit_m` is given (0: it is not). Finds the palm by the side to which the fingers
/// bend, and with it whether the hand is a left one, in axes of a right-handed frame. The hand may
/// be turned and moved.
/// Lost are frames in which a point is missing, all points are the same, or all are those of the
/// frame before for more than 5 frames.
/// Errors: UserError without a place, if
/// - all frames are lost,
/// - the size is that of a hand in no unit, as of landmarks in an image,
/// - the wrist is at depth 0 and moves, as landmarks in an image do,
/// - lengths of bones change by more than 25 %, or
/// - the fingers never bend, so the palm is unknown.
PlacedHand PlaceHand(std::vector<HandPoints> points, double unit_m);

/// True if the numbers are those of a hand, where no names tell it: its bones keep their lengths
/// within 10 %, their shares of a finger are those of a hand, and it has the size of a hand in m,
/// cm or mm.
bool LooksLikeHand(const std::vector<HandPoints>& points);

/// Channels of the joints of the fingers, index to little, from the knuckle on.
inline constexpr std::array<std::array<std::string_view, 3>, 4> kFingerChannels = {
    {{"index_mcp", "index_pip", "index_dip"},
     {"middle_mcp", "middle_pip", "middle_dip"},
     {"ring_mcp", "ring_pip", "ring_dip"},
     {"little_mcp", "little_pip", "little_dip"}}};

/// Angles of joints from keypoints, by channel.
struct KeypointAngles {
  std::vector<std::string_view> channels;  // names of KnownChannels()
  Eigen::MatrixXd angle_deg;               // frames x channels; NaN where the frame is lost
  double residual_m = 0.0;                 // RMS, see AnglesOf()
};

/// Angles by these equations, in the frame of PlacedHand. d1, d2, d3 are the unit vectors of the
/// phalanges of a finger from the knuckle to the tip.
///
///     spread of a finger  a = atan2(s d1.y, s d1.x), s = sign(d1.x); held beyond 70 deg of flexion
///     flexion axis        h = (-sin a, cos a, 0), u = (cos a, sin a, 0)
///     MCP                 atan2(-d1.z, d1 . u)
///     PIP, DIP            atan2((d1 x d2) . h, d1 . d2), the same with d2, d3
///     finger_spread       (a of the index finger - a of the little finger) / 2
///
/// Thumb, as the joints of models/hand_arm.xml turn, with t along the metacarpal:
///
///     thumb_abduction     acos(t.x)
///     thumb_rotation      atan2(-t.z, t.y); held where the thumb lies along x within 10 deg
///     thumb_mcp, thumb_ip angle between neighbouring bones, with the sign of their mean hinge
///
/// The residual is the RMS distance of the PIP, DIP and tip of fingers from those of a hand with
/// these angles and the median lengths: noise, and bending out of the plane of the finger.
/// Sources: the plane of wrist and knuckles for flexion and abduction, as Cejnog et al. use it; the
/// axes of the thumb in models/parts/thumb_base.xml.
KeypointAngles AnglesOf(const PlacedHand& hand);

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
