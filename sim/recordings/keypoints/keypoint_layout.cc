#include "sim/recordings/keypoints/keypoint_layout.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>
#include <set>
#include <utility>

#include "controller/number.h"
#include "sim/base/csv_line.h"
#include "sim/base/text.h"
#include "sim/tables/name_words.h"
#include "sim/tables/time_columns.h"

namespace gauntlet::sim {
namespace {

using NameWords = std::vector<std::string>;

constexpr std::array<std::string_view, kDigitsOfHand> kDigitNames = {"thumb", "index", "middle",
                                                                     "ring", "little"};

/// A joint as a name calls it; what it is depends on the others of its digit.
enum class CalledJoint { kNone, kWrist, kHand, kOther, kBase, kMcp, kPip, kIp, kDip, kTip };

/// Quantity of a joint in a column.
enum class Part { kPosition, kRadius, kConfidence, kRotation, kOther };

using Space = RotationColumns::Space;

/// The name of a column, taken apart.
struct ColumnParts {
  std::string stem;  // the rest
  std::string hand;
  int digit = -1;
  CalledJoint joint = CalledJoint::kNone;
  int number = -1;  // of the joint, where it has one and no name
  Part part = Part::kOther;
  int component = -1;  // 0 to 2 by an axis, of a rotation 0 to 3 for w, x, y, z
  int place = -1;      // by a number, as it is in the name
  double unit_m = 0.0;
  Space space = Space::kUnknown;
  bool has_openxr_word = false;
  bool has_rokoko_word = false;
};

constexpr std::string_view kRotations =
    "rot rotation quat quaternion orientation euler vel velocity acc acceleration angular qx qy qz "
    "qw rx ry rz w gyro angle";

int NumberIn(const std::string& word) {
  constexpr int kMost = 100000;
  return static_cast<int>(controller::ParseWholeNumber(word, 0, kMost).value_or(-1));
}

double TakeUnit(NameWords& words) {
  constexpr std::array<std::pair<std::string_view, double>, 3> kUnits = {
      {{"m", 1.0}, {"cm", 1e-2}, {"mm", 1e-3}}};
  if (words.size() < 2) return 0.0;
  for (const auto& [name, unit_m] : kUnits) {
    if (words.back() != name) continue;
    words.pop_back();
    return unit_m;
  }
  return 0.0;
}

int AxisOf(std::string_view word) {
  if (word.size() == 2 && word[0] == 'p') word.remove_prefix(1);
  return word.size() == 1 && word[0] >= 'x' && word[0] <= 'z' ? word[0] - 'x' : -1;
}

/// Name of a component of a quaternion: `qw`, `w`, `rot_w`, `qw5`.
struct QuaternionComponent {
  int component = -1;  // 0 to 3 for w, x, y, z; -1: none
  std::string prefix;
  int number = -1;  // of the joint, behind it
};

/// Removes it from the words.
QuaternionComponent TakeQuaternionComponent(NameWords& words) {
  constexpr std::string_view kComponents = "wxyz";
  if (words.empty()) return {};
  const bool is_numbered = words.size() >= 2 && NumberIn(words.back()) >= 0;
  const auto last = words.end() - (is_numbered ? 2 : 1);
  QuaternionComponent taken;
  for (const std::string_view prefix : {"quat", "rot", "ori", "q", "r"}) {
    if (last->size() == prefix.size() + 1 && last->starts_with(prefix)) taken.prefix = prefix;
  }
  const std::size_t place = kComponents.find(last->back());
  if (last->size() != taken.prefix.size() + 1 || place == std::string_view::npos) return {};
  taken.component = static_cast<int>(place);
  if (is_numbered) taken.number = NumberIn(words.back());
  words.erase(last, words.end());
  return taken;
}

/// Component of each column that is one of the four of a quaternion; -1: none.
std::vector<int> QuaternionComponents(const std::vector<std::string>& names) {
  std::vector<int> components;
  std::vector<std::string> rests;
  std::map<std::string, std::set<int>> found;
  for (const std::string& name : names) {
    NameWords words = WordsOf(name);
    const bool is_other = HasWordOf(words, "euler vel velocity acc acceleration angular gyro");
    const QuaternionComponent taken =
        is_other ? QuaternionComponent() : TakeQuaternionComponent(words);
    components.push_back(taken.component);
    rests.push_back(fmt::format("{} {} {}", fmt::join(words, " "), taken.prefix, taken.number));
    if (taken.component >= 0) found[rests.back()].insert(taken.component);
  }
  for (std::size_t c = 0; c < names.size(); ++c) {
    if (components[c] >= 0 && found[rests[c]].size() < 4) components[c] = -1;
  }
  return components;
}

/// Removes the component of a rotation, and what the name says of it.
void TakeRotation(NameWords& words, int component, ColumnParts& parts) {
  parts.part = Part::kRotation;
  parts.component = component;
  parts.number = TakeQuaternionComponent(words).number;
  static constexpr std::string_view kLocal = "local relative parent";
  static constexpr std::string_view kWorld = "world global absolute";
  if (HasWordOf(words, kLocal)) parts.space = Space::kLocal;
  if (HasWordOf(words, kWorld)) parts.space = Space::kWorld;
  std::erase_if(words, [](const std::string& word) {
    return IsWordOf(kLocal, word) || IsWordOf(kWorld, word) || IsWordOf(kRotations, word);
  });
}

/// Removes the axis, or the number of the value, and says of what.
void TakeComponent(NameWords& words, int quaternion_component, ColumnParts& parts) {
  if (quaternion_component >= 0) {
    TakeRotation(words, quaternion_component, parts);
    return;
  }
  if (HasWordOf(words, kRotations)) return;
  if (HasWordOf(words, "radius")) {
    parts.part = Part::kRadius;
    std::erase(words, "radius");
    return;
  }
  static constexpr std::string_view kConfidences =
      "confidence score visibility presence tracked valid is";
  if (HasWordOf(words, kConfidences)) {
    parts.part = Part::kConfidence;
    std::erase_if(words, [](const std::string& word) { return IsWordOf(kConfidences, word); });
    return;
  }
  const std::size_t count = words.size();
  if (count >= 2 && AxisOf(words[count - 2]) >= 0 && NumberIn(words.back()) >= 0) {  // x6
    parts.component = AxisOf(words[count - 2]);
    parts.number = NumberIn(words.back());
    words.resize(count - 2);
  } else if (count >= 1 && AxisOf(words.back()) >= 0) {  // index_tip_x
    parts.component = AxisOf(words.back());
    words.pop_back();
  } else if (count >= 2 && AxisOf(words.front()) >= 0) {  // x_index_tip
    parts.component = AxisOf(words.front());
    words.erase(words.begin());
  } else if (count >= 1 && NumberIn(words.back()) >= 0) {
    parts.place = NumberIn(words.back());
    words.pop_back();
  } else {
    return;
  }
  parts.part = Part::kPosition;
}

/// The joint that the words behind a finger call.
CalledJoint JointCalled(const NameWords& words) {
  const bool is_tip = HasWordOf(words, "tip");
  if (HasWordOf(words, "intermediate")) return is_tip ? CalledJoint::kDip : CalledJoint::kPip;
  if (is_tip) return CalledJoint::kTip;
  if (HasWordOf(words, "metacarpal cmc")) return CalledJoint::kBase;
  if (HasWordOf(words, "mcp mpj knuckle proximal")) return CalledJoint::kMcp;
  if (HasWordOf(words, "pip pij middle medial")) return CalledJoint::kPip;
  if (HasWordOf(words, "ip")) return CalledJoint::kIp;
  if (HasWordOf(words, "dip dij distal")) return CalledJoint::kDip;
  return CalledJoint::kNone;
}

void TakeJoint(NameWords& words, ColumnParts& parts) {
  const auto finger =
      std::ranges::find_if(words, [](const std::string& word) { return !FingerOf(word).empty(); });
  if (finger != words.end()) {
    const NameWords behind(finger + 1, words.end());
    parts.digit =
        static_cast<int>(std::ranges::find(kDigitNames, FingerOf(*finger)) - kDigitNames.begin());
    parts.joint = JointCalled(behind);
    // The thumb of Apple begins with its knuckle.
    if (parts.digit == 0 && HasWordOf(behind, "knuckle")) parts.joint = CalledJoint::kBase;
    if (parts.digit == 0 && parts.joint == CalledJoint::kPip && HasWordOf(behind, "intermediate")) {
      parts.joint = CalledJoint::kMcp;
    }
    words.erase(finger, words.end());
    return;
  }
  if (HasWordOf(words, "wrist")) {
    parts.joint = HasWordOf(words, "forearm") ? CalledJoint::kOther : CalledJoint::kWrist;
  } else if (HasWordOf(words, "palm forearm elbow")) {
    parts.joint = CalledJoint::kOther;
  } else if (parts.number < 0 && !words.empty() && NumberIn(words.back()) >= 0) {
    parts.number = NumberIn(words.back());
    words.pop_back();
  } else if (parts.number < 0 && HasWordOf(words, "hand")) {
    parts.joint = CalledJoint::kHand;
  }
}

ColumnParts PartsOfColumn(const std::string& name, int quaternion_component) {
  // Words that some joints of a skeleton have and others do not.
  static constexpr std::string_view kNeutral =
      "finger fingers phalanx joint joints bone xr hand hands base pos position positions "
      "translation location pose wrist palm forearm arm r l";
  NameWords words = WordsOf(name);
  ColumnParts parts;
  parts.unit_m = TakeUnit(words);
  parts.has_openxr_word = HasWordOf(words, "intermediate");
  parts.has_rokoko_word = HasWordOf(words, "medial");
  TakeComponent(words, quaternion_component, parts);
  std::erase_if(words, [](const std::string& word) {
    return IsWordOf("pos position positions translation location", word);
  });
  for (const std::string& word : words) {
    if (parts.hand.empty()) parts.hand = SideOf(word);
  }
  std::erase_if(words, [](const std::string& word) { return !SideOf(word).empty(); });
  TakeJoint(words, parts);
  std::erase_if(words, [](const std::string& word) {
    return IsWordOf(kNeutral, word) || IsWordOf(kRotations, word);
  });
  parts.stem = fmt::format("{}", fmt::join(words, " "));
  return parts;
}

// --- Named joints --------------------------------------------------------------------------------

/// Keypoints of the joints of a digit by what they are called; -1: none of the 21.
std::map<CalledJoint, int> JointsOf(int digit, const std::set<CalledJoint>& called) {
  using enum CalledJoint;
  const bool is_thumb = digit == 0;
  std::map<CalledJoint, int> joints = {{kTip, 3}, {kDip, 2}, {kIp, 2}};
  if (is_thumb && (called.contains(kBase) || !called.contains(kPip))) {
    joints[kBase] = 0;
    joints[kMcp] = 1;
    if (!called.contains(kIp) && !called.contains(kDip)) joints[kPip] = 2;
  } else if (!is_thumb && called.contains(kIp)) {
    joints[kPip] = 0;  // Manus calls the base MCP
    joints[kIp] = 1;
  } else {  // of a thumb: names of a finger, from the root on
    joints[kMcp] = 0;
    joints[kPip] = 1;
  }
  return joints;
}

using GroupKey = std::pair<std::string, std::string>;  // hand, stem

struct NamedColumn {
  std::size_t column = 0;
  ColumnParts parts;
};

/// Places of x, y and z among the values of a joint that are numbered; empty: not known.
std::vector<int> PlacesOfPosition(const std::vector<int>& places) {
  const int first = places.empty() ? -1 : places.front();
  const bool is_row = !places.empty() && places.back() - first + 1 == std::ssize(places);
  if (!is_row || first < 0 || first > 1) return {};
  if (places.size() == 3 || places.size() == 4 || places.size() == 7) {
    return {first, first + 1, first + 2};
  }
  constexpr int kTranslation = 12;  // of a matrix of 4 x 4, column by column
  if (places.size() == 16) return {first + kTranslation, first + 13, first + 14};
  return {};
}

/// Columns of the positions of one joint, if it has all three.
std::optional<std::array<std::size_t, 3>> PositionIn(const std::vector<NamedColumn>& columns,
                                                     double& unit_m) {
  std::array<std::size_t, 3> position = {};
  std::map<int, std::size_t> by_place, by_axis;
  for (const NamedColumn& column : columns) {
    if (column.parts.part != Part::kPosition) continue;
    if (column.parts.component >= 0) by_axis.emplace(column.parts.component, column.column);
    if (column.parts.place >= 0) by_place.emplace(column.parts.place, column.column);
    unit_m = std::max(unit_m, column.parts.unit_m);
  }
  if (by_axis.size() == 3) {
    for (const auto& [axis, column] : by_axis) position[static_cast<std::size_t>(axis)] = column;
    return position;
  }
  std::vector<int> places;
  for (const auto& [place, column] : by_place) places.push_back(place);
  const std::vector<int> of_position = PlacesOfPosition(places);
  if (of_position.empty()) return std::nullopt;
  for (std::size_t i = 0; i < 3; ++i) position[i] = by_place.at(of_position[i]);
  return position;
}

/// A hand with the joints that it has, and those that it lacks.
struct FoundHand {
  KeypointColumns columns;
  std::string stem;
  std::vector<std::string> missing = {};
};

/// Names of the joints of a group.
struct CalledJoints {
  std::array<std::set<CalledJoint>, kDigitsOfHand> of_digit = {};
  bool has_wrist = false;
  bool is_rokoko = false;

  explicit CalledJoints(const std::vector<NamedColumn>& group) {
    for (const NamedColumn& column : group) {
      has_wrist = has_wrist || column.parts.joint == CalledJoint::kWrist;
      is_rokoko = is_rokoko || column.parts.has_rokoko_word;
      if (column.parts.digit < 0) continue;
      of_digit[static_cast<std::size_t>(column.parts.digit)].insert(column.parts.joint);
    }
  }
  bool IsManus() const { return of_digit[1].contains(CalledJoint::kIp); }
};

std::optional<FoundHand> NamedHand(const GroupKey& key, const std::vector<NamedColumn>& group) {
  FoundHand hand{.columns = {.hand = key.first, .skeleton = "by name"}, .stem = key.second};
  const CalledJoints called(group);
  const bool is_manus = called.IsManus();
  // Elsewhere a hand may be the palm.
  const CalledJoint wrist = called.has_wrist               ? CalledJoint::kWrist
                            : is_manus || called.is_rokoko ? CalledJoint::kHand
                                                           : CalledJoint::kNone;
  std::map<int, std::vector<NamedColumn>> columns_of;
  for (const NamedColumn& column : group) {
    hand.columns.all.push_back(column.column);
    if (column.parts.joint == wrist) columns_of[0].push_back(column);
    if (column.parts.digit < 0) continue;
    const auto joints =
        JointsOf(column.parts.digit, called.of_digit[static_cast<std::size_t>(column.parts.digit)]);
    const auto joint = joints.find(column.parts.joint);
    if (joint == joints.end()) continue;
    columns_of[KeypointOf(column.parts.digit, joint->second)].push_back(column);
    if (column.parts.part == Part::kRadius && joint->second == kJointsOfDigit - 1) {
      hand.columns.tip_radius[static_cast<std::size_t>(column.parts.digit)] = column.column;
    }
  }
  for (int keypoint = 0; keypoint < kKeypoints; ++keypoint) {
    const auto position = PositionIn(columns_of[keypoint], hand.columns.unit_m);
    if (position) {
      hand.columns.position[static_cast<std::size_t>(keypoint)] = *position;
    } else {
      hand.missing.push_back(KeypointName(keypoint));
    }
  }
  if (is_manus) hand.columns.skeleton = "by name, as Manus names them";
  constexpr std::size_t kMostMissing = 10;
  if (hand.missing.size() > kMostMissing) return std::nullopt;
  return hand;
}

// --- Numbered joints -----------------------------------------------------------------------------

/// Numbers of the 21 keypoints among the joints of a skeleton; empty for another number of joints.
std::vector<int> OrderOf(std::size_t joints) {
  const int before = joints == 26 ? 1 : 0;  // the palm of OpenXR
  std::vector<int> order = {before};
  if (joints == kKeypoints) {
    for (int i = 1; i < kKeypoints; ++i) order.push_back(i);
    return order;
  }
  if (joints < 25 || joints > 27) return {};
  for (int i = 1; i <= kJointsOfDigit; ++i) order.push_back(before + i);
  for (int finger = 0; finger < 4; ++finger) {
    const int metacarpal = before + 5 + 5 * finger;
    for (int i = 1; i <= kJointsOfDigit; ++i) order.push_back(metacarpal + i);
  }
  return order;
}

std::string SkeletonOf(std::size_t joints) {
  if (joints == kKeypoints) return "21 in the order of MediaPipe";
  if (joints == 26) return "26 in the order of OpenXR";
  return fmt::format("{} in the order of WebXR and ARKit", joints);
}

/// True for words of the points of a hand.
bool NamesPoints(const std::string& stem) {
  return HasWordOf(WordsOf(stem), "landmark landmarks keypoint keypoints lm kp handmarks");
}

/// A hand of joints that are numbered from 0 or 1, each with its values.
std::optional<FoundHand> NumberedHand(const GroupKey& key, const std::vector<NamedColumn>& group) {
  std::map<int, std::vector<NamedColumn>> columns_of;
  for (const NamedColumn& column : group) columns_of[column.parts.number].push_back(column);
  const int first = columns_of.begin()->first;
  const bool is_row = columns_of.rbegin()->first - first + 1 == std::ssize(columns_of);
  const std::vector<int> order = OrderOf(columns_of.size());
  if (order.empty() || !is_row || first > 1) return std::nullopt;
  FoundHand hand{.columns = {.hand = key.first, .skeleton = SkeletonOf(columns_of.size())},
                 .stem = key.second};
  hand.columns.is_named = NamesPoints(key.second);
  for (const NamedColumn& column : group) hand.columns.all.push_back(column.column);
  for (int keypoint = 0; keypoint < kKeypoints; ++keypoint) {
    const auto position = PositionIn(columns_of[first + order[static_cast<std::size_t>(keypoint)]],
                                     hand.columns.unit_m);
    if (!position) return std::nullopt;
    hand.columns.position[static_cast<std::size_t>(keypoint)] = *position;
  }
  return hand;
}

// --- Rotations -----------------------------------------------------------------------------------

/// Columns of the quaternion of one bone; none if a component is missing or there twice.
std::optional<std::array<std::size_t, 4>> QuaternionIn(const std::vector<NamedColumn>& columns) {
  std::array<std::size_t, 4> quaternion = {};
  std::set<int> components;
  for (const NamedColumn& column : columns) {
    components.insert(column.parts.component);
    quaternion[static_cast<std::size_t>(column.parts.component)] = column.column;
  }
  if (columns.size() != 4 || components.size() != 4) return std::nullopt;
  return quaternion;
}

/// The rotations of a hand whose bones have the columns; none if one that angles need is missing.
std::optional<FoundHand> TurnedHand(const GroupKey& key, const std::vector<NamedColumn>& group,
                                    const std::map<int, std::vector<NamedColumn>>& columns_of) {
  FoundHand hand{.columns = {.hand = key.first, .skeleton = "by name"}, .stem = key.second};
  RotationColumns& rotations = hand.columns.rotations.emplace();
  for (const NamedColumn& column : group) hand.columns.all.push_back(column.column);
  bool any_local = false;
  for (const auto& [bone, columns] : columns_of) {
    for (const NamedColumn& column : columns) {
      any_local = any_local || column.parts.space == Space::kLocal;
    }
  }
  for (const auto& [bone, columns] : columns_of) {
    std::vector<NamedColumn> of_bone = columns;
    if (any_local) {  // beside others
      std::erase_if(of_bone, [](const NamedColumn& c) { return c.parts.space != Space::kLocal; });
    }
    auto& quaternion = rotations.bone[static_cast<std::size_t>(bone)];
    quaternion = QuaternionIn(of_bone);
    if (!quaternion) continue;
    const ColumnParts& parts = of_bone.front().parts;
    rotations.has_openxr_names = rotations.has_openxr_names || parts.has_openxr_word;
    rotations.space = parts.space;
  }
  for (int digit = 0; digit < kDigitsOfHand; ++digit) {
    for (int bone = digit == 0 ? 0 : 1; bone < kBonesOfDigit; ++bone) {
      const bool is_needed = digit > 0 || bone != 2;
      const auto place = static_cast<std::size_t>(TurnedBone(digit, bone));
      if (is_needed && !rotations.bone[place]) return std::nullopt;
    }
  }
  return hand;
}

std::optional<FoundHand> NamedTurnedHand(const GroupKey& key,
                                         const std::vector<NamedColumn>& group) {
  const CalledJoints called(group);
  const CalledJoint wrist = called.has_wrist ? CalledJoint::kWrist : CalledJoint::kHand;
  const CalledJoint metacarpal = called.IsManus() ? CalledJoint::kMcp : CalledJoint::kBase;
  std::map<int, std::vector<NamedColumn>> columns_of;
  for (const NamedColumn& column : group) {
    const ColumnParts& parts = column.parts;
    if (parts.part != Part::kRotation) continue;
    if (parts.joint == wrist) columns_of[0].push_back(column);
    if (parts.digit < 0) continue;
    if (parts.digit > 0 && parts.joint == metacarpal) {
      columns_of[TurnedBone(parts.digit, 0)].push_back(column);
      continue;
    }
    const auto joints =
        JointsOf(parts.digit, called.of_digit[static_cast<std::size_t>(parts.digit)]);
    const auto joint = joints.find(parts.joint);
    if (joint == joints.end() || joint->second == kJointsOfDigit - 1) continue;
    const bool is_distal_of_thumb = parts.digit == 0 && joint->second == 2;
    const int bone = parts.digit > 0 || is_distal_of_thumb ? joint->second + 1 : joint->second;
    columns_of[TurnedBone(parts.digit, bone)].push_back(column);
  }
  auto hand = TurnedHand(key, group, columns_of);
  if (hand && called.IsManus()) hand->columns.skeleton = "by name, as Manus names them";
  return hand;
}

// --- Hands ---------------------------------------------------------------------------------------

std::vector<FoundHand> HandsOf(const std::vector<ColumnParts>& columns) {
  std::map<GroupKey, std::vector<NamedColumn>> named, numbered, listed;
  for (std::size_t c = 0; c < columns.size(); ++c) {
    const ColumnParts& parts = columns[c];
    const GroupKey key(parts.hand, parts.stem);
    if (parts.joint != CalledJoint::kNone) {
      named[key].push_back({c, parts});
    } else if (parts.number >= 0) {
      numbered[key].push_back({c, parts});
    } else if (parts.part == Part::kPosition && NamesPoints(key.second)) {
      listed[key].push_back({c, parts});
    }
  }
  std::vector<FoundHand> hands;
  const auto add = [&hands](std::optional<FoundHand> hand) {
    if (hand) hands.push_back(std::move(*hand));
  };
  for (const auto& [key, group] : named) add(NamedHand(key, group));
  for (const auto& [key, group] : numbered) add(NumberedHand(key, group));
  for (auto& [key, group] :
       listed) {  // landmarks_1 to landmarks_63: x, y, z of one after the other
    std::ranges::sort(group, {}, [](const NamedColumn& column) { return column.parts.place; });
    for (NamedColumn& column : group) {
      const int value = column.parts.place - std::clamp(group.front().parts.place, 0, 1);
      column.parts.number = value / 3;
      column.parts.component = value % 3;
    }
    add(NumberedHand(key, group));
  }
  if (!hands.empty()) return hands;
  for (const auto& [key, group] : named) add(NamedTurnedHand(key, group));
  return hands;
}

/// World landmarks, where there are any, instead of those in the image.
void PreferWorld(std::vector<FoundHand>& hands) {
  const auto is_world = [](const FoundHand& hand) {
    return HasWordOf(WordsOf(hand.stem), "world");
  };
  if (std::ranges::none_of(hands, is_world)) return;
  std::vector<std::size_t> others;
  std::erase_if(hands, [&](const FoundHand& hand) {
    if (is_world(hand)) return false;
    others.insert(others.end(), hand.columns.all.begin(), hand.columns.all.end());
    return true;
  });
  std::vector<std::size_t>& all = hands.front().columns.all;  // so that they are left out
  all.insert(all.end(), others.begin(), others.end());
}

/// True for two hands that are numbered, as `value 1` and `value 2`: their shape tells the side.
bool ArePair(const std::vector<FoundHand>& hands) {
  const auto base = [](const FoundHand& hand) {
    return hand.stem.substr(0, hand.stem.find_last_not_of("0123456789") + 1);
  };
  return hands.size() == 2 && base(hands[0]) == base(hands[1]) &&
         std::ranges::all_of(hands, [](const FoundHand& hand) {
           return hand.columns.hand.empty() && !hand.columns.rotations;
         });
}

std::string NameOfHand(const FoundHand& hand) {
  const std::string name = hand.columns.hand + (hand.stem.empty() ? "" : " " + hand.stem);
  return name.empty() ? "without a name" : OneLine(Trimmed(name), 40);
}

void FindConfidence(const std::vector<ColumnParts>& columns, KeypointColumns& hand) {
  for (std::size_t c = 0; c < columns.size(); ++c) {
    const ColumnParts& parts = columns[c];
    const bool is_of_hand =
        parts.digit < 0 && parts.number < 0 && (parts.hand.empty() || parts.hand == hand.hand);
    if (parts.part == Part::kConfidence && is_of_hand && !hand.confidence) hand.confidence = c;
  }
}

}  // namespace

std::string KeypointName(int keypoint) {
  if (keypoint == 0) return "wrist";
  const int digit = (keypoint - 1) / kJointsOfDigit;
  const int joint = (keypoint - 1) % kJointsOfDigit;
  constexpr std::array<std::string_view, kJointsOfDigit> kThumb = {"cmc", "mcp", "ip", "tip"};
  constexpr std::array<std::string_view, kJointsOfDigit> kFinger = {"mcp", "pip", "dip", "tip"};
  const auto place = static_cast<std::size_t>(joint);
  return fmt::format("{}_{}", kDigitNames[static_cast<std::size_t>(digit)],
                     digit == 0 ? kThumb[place] : kFinger[place]);
}

KeypointLayout FindKeypoints(const std::vector<std::string>& names, Quaternions quaternions) {
  KeypointLayout layout;
  std::vector<ColumnParts> columns;
  std::vector<int> quaternion_component(names.size(), -1);
  if (quaternions == Quaternions::kTaken) quaternion_component = QuaternionComponents(names);
  for (std::size_t c = 0; c < names.size(); ++c) {
    columns.push_back(PartsOfColumn(names[c], quaternion_component[c]));
  }
  std::vector<FoundHand> hands = HandsOf(columns);
  PreferWorld(hands);
  const bool any_whole =
      std::ranges::any_of(hands, [](const FoundHand& hand) { return hand.missing.empty(); });
  if (any_whole) std::erase_if(hands, [](const auto& hand) { return !hand.missing.empty(); });
  for (const FoundHand& hand : hands) {
    if (hand.missing.empty()) continue;
    layout.problem = fmt::format(
        "has no x, y and z of {}; keypoints of a hand are the wrist and four joints of each digit",
        fmt::join(hand.missing, ", "));
    return layout;
  }
  for (std::size_t i = ArePair(hands) ? 2 : 1; i < hands.size(); ++i) {
    for (std::size_t k = 0; k < i; ++k) {
      if (hands[i].columns.hand != hands[k].columns.hand && !hands[i].columns.hand.empty() &&
          !hands[k].columns.hand.empty()) {
        continue;
      }
      layout.has_several = true;
      layout.problem =
          fmt::format("has keypoints of several hands or kinds ({}; {}); keep those of one",
                      NameOfHand(hands[k]), NameOfHand(hands[i]));
      return layout;
    }
  }
  for (FoundHand& hand : hands) {
    FindConfidence(columns, hand.columns);
    layout.hands.push_back(std::move(hand.columns));
  }
  return layout;
}

}  // namespace gauntlet::sim
