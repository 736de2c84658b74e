#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace gauntlet::sim {

/// Sensor of the wearer's hand as named by a column.
struct NamedSensor {
  std::string finger = {};   // thumb, index, middle, ring or little; empty: not named
  std::string joint = {};    // part of a channel's name, such as mcp; empty: not named
  bool is_spread = false;    // measures the angle between fingers
  std::string channel = {};  // channel of both; empty: needs the other columns
};
NamedSensor ReadSensorName(std::string_view name);

/// A column's name by the grammar of joints: [side] finger joint [flex|angle|pos] [unit], or the
/// name of a channel, in any order and case.
struct JointName {
  bool is_joint = false;   // names a finger, the spread of fingers, or a part of the arm
  std::string side = {};   // left, right; empty: not named
  std::string other = {};  // words that the grammar does not have, with blanks; empty: exact
};
JointName ReadJointName(std::string_view name);

/// Evidence for the joint of a column.
enum class JointBasis { kName, kProfile, kMap, kAssumed };

/// The joint that a column drives.
struct ColumnJoint {
  std::string channel = {};  // empty: none
  JointBasis basis = JointBasis::kName;
  std::string why = {};
};

/// Joints of columns by their names. `question` receives a sentence if two columns name one joint;
/// of several sensors of the spread between fingers the first drives it. The only sensor of a
/// finger without a joint is assumed to be that of its middle joint; several are a question.
std::vector<ColumnJoint> JointsByNames(const std::vector<std::string>& names,
                                       std::string& question);

}  // namespace gauntlet::sim
