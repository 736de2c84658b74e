#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace gauntlet::sim {

/// A joint of a digit, by its name in the skeleton of a body.
struct DigitJoint {
  std::string hand;  // left or right; empty: the name does not tell
  int digit = 0;     // 0: thumb .. 4: little finger
  int bone = 0;      // that turns at it, as in TurnedBone(); or one of these
  static constexpr int kEnd = 4;
  static constexpr int kUnclear = -1;  // may be another bone in another skeleton
};

/// None for names of other joints. Known are, in any case and behind any prefix, with the side in
/// front or at the end:
///
/// | names                                              | of                                     |
/// |----------------------------------------------------|----------------------------------------|
/// | `RightHandIndex1`, `index.01.R`, `index_01_r`      | Mixamo, Rokoko, Blender, Unreal        |
/// | `RightInHandIndex`                                 | Perception Neuron: the metacarpal      |
/// | `RightIndexProximal`, `RightFinger2Medial`         | Rokoko; finger 1 is the thumb          |
/// | `RightDigit2ProximalPhalanx`, `RightSecondPP`      | digits by number, 1 is the thumb; Xsens |
/// | `INDEX_PIP`                                        | the joint at which the bone turns      |
///
/// The numbers 1, 2, 3 are the proximal, middle and distal bone of a finger, or the metacarpal,
/// proximal and distal one of a thumb. 4, `tip` and `end` are the end of the digit.
std::optional<DigitJoint> DigitJointOf(std::string_view name);

/// `index_middle`, with the bones of TurnedBone().
std::string BoneName(int digit, int bone);

}  // namespace gauntlet::sim
