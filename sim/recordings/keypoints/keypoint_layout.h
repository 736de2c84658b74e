#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace gauntlet::sim {

/// Keypoints of a hand, in the order of MediaPipe: the wrist, then four joints of each digit from
/// the base to the tip. Source: MediaPipe, docs/solutions/hands.md, HandLandmark.
inline constexpr int kKeypoints = 21;
inline constexpr int kDigitsOfHand = 5;
inline constexpr int kJointsOfDigit = 4;
/// Place of a joint (0 to 3, from the base) of a digit (0: thumb .. 4: little finger).
constexpr int KeypointOf(int digit, int joint) { return 1 + kJointsOfDigit * digit + joint; }
/// `wrist`, `thumb_cmc`, `index_mcp`, `index_tip` ..
std::string KeypointName(int keypoint);

/// Rotations of bones: the hand (the wrist's), then four bones of each digit, metacarpal, proximal,
/// middle and distal. A thumb has no middle one.
inline constexpr int kTurnedBones = 21;
inline constexpr int kBonesOfDigit = 4;
constexpr int TurnedBone(int digit, int bone) { return 1 + kBonesOfDigit * digit + bone; }

/// Columns of the unit quaternions of a hand's bones.
struct RotationColumns {
  enum class Space { kUnknown, kLocal, kWorld };
  std::array<std::optional<std::array<std::size_t, 4>>, kTurnedBones> bone = {};  // w, x, y, z
  Space space = Space::kUnknown;  // relative to the parent bone or to the world, by the names
  bool has_openxr_names = false;
};

/// Columns of the keypoints of one hand in a table.
struct KeypointColumns {
  std::string hand;      // left or right, by the names; empty: they do not tell
  std::string skeleton;  // for a person
  std::array<std::array<std::size_t, 3>, kKeypoints> position = {};  // x, y, z
  std::array<std::optional<std::size_t>, kDigitsOfHand> tip_radius = {};
  std::optional<std::size_t> confidence = {};
  std::vector<std::size_t> all = {};  // of this hand, with rotations and other joints
  double unit_m = 0.0;                // of the positions, by the names; 0: they do not tell
  bool is_named = true;  // false: by the number of the points, so the geometry has to agree
  std::optional<RotationColumns> rotations = {};  // instead of positions
};

/// Keypoints that the names of a table tell.
struct KeypointLayout {
  std::vector<KeypointColumns> hands;  // none: no keypoints, or a problem
  std::string problem;                 // why a table that has keypoints is not read
  bool has_several = false;            // the problem is hands or kinds that names do not tell apart
};

/// Treatment of columns that differ in w, x, y and z only: those of a quaternion, or of a point.
enum class Quaternions { kTaken, kLeft };

/// Finds the keypoints of hands by the names of columns: a joint and an axis, or a number and an
/// axis. Known are
///
/// | skeleton           | joints | names                                                       |
/// |--------------------|--------|-------------------------------------------------------------|
/// | MediaPipe          | 21     | `INDEX_FINGER_PIP_x`, `landmarks_6_x`, `x6`                 |
/// | OpenXR             | 26     | `index_intermediate_x`; by number with the palm in front    |
/// | WebXR, ARKit       | 25, 27 | `index-finger-phalanx-intermediate_x`, `indexKnuckle_13`    |
/// | HoloLens           | 26     | `IndexMiddleJoint_x`                                        |
/// | Manus              | 25     | `Index_MCP` .. `Index_TIP` of five joints: MCP is the base  |
/// | Rokoko             | 21     | `leftIndexMedial_position_x`, `leftHand_position_x`         |
/// | names of a finger  | 21     | `thumb_mcp`, `thumb_pip`, `thumb_dip`: the base is the CMC  |
///
/// A joint has 3 values, 7 (position and quaternion) or 16 (a matrix, column by column as ARKit and
/// WebXR write it; the translation has the places 13 to 15). A unit behind the axis (_m, _cm, _mm)
/// is that of the column. World landmarks are taken before others.
///
/// Without positions, a hand is also the rotations of its bones, one quaternion each: of the same
/// joints, named after the bone beyond them. A quaternion has columns that differ in w, x, y and z
/// only (`index_proximal_qw`, `index_proximal.orientation.w`). `local` and `world` in a name tell
/// what it is relative to.
/// Sources: MediaPipe, hands.md; OpenXR 1.0, XrHandJointEXT; WebXR Hand Input, XRHandJoint;
/// Apple, ARKit, HandSkeleton.JointName; Manus SDK, FingerJointType.
KeypointLayout FindKeypoints(const std::vector<std::string>& names,
                             Quaternions quaternions = Quaternions::kTaken);

}  // namespace gauntlet::sim
