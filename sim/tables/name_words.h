#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace gauntlet::sim {

/// A meaning, and the words that have it, with blanks between them.
struct Meaning {
  std::string_view means;
  std::string_view words;
};
/// The meaning of a word; empty if the list has none.
std::string_view MeaningOf(std::span<const Meaning> list, std::string_view word);

/// Words of a name in lower case: `IndexPIP_deg2` is index, pip, deg, 2.
std::vector<std::string> WordsOf(std::string_view name);

/// The names with thumb, index .. in place of the first words T, I, M, R and L or P, as of a
/// CyberGlove, where all five stand in front: R and L are no sides there.
std::vector<std::string> WithFingers(std::vector<std::string> names);

/// The names with a finger in place of each `digit 1` (thumb) to `digit 5`, as of Rokoko.
std::vector<std::string> WithDigits(std::vector<std::string> names);

/// The names with mcp, pip, dip, ip or cmc in place of an anatomical name, as of Rokoko:
/// `ProximalInterphalangeal`.
std::vector<std::string> WithJoints(std::vector<std::string> names);

/// The names with fingers in English, if three or more are named in Italian, French, Spanish,
/// German, Portuguese or Dutch; else none.
std::vector<std::string> InEnglish(const std::vector<std::string>& names);

/// True if one of `words` is in the list, which has blanks between its words.
bool HasWordOf(const std::vector<std::string>& words, std::string_view list);

/// thumb, index, middle, ring or little; empty for other words.
std::string_view FingerOf(std::string_view word);
/// The finger of a joint by its name, as HandKinematics asks for it: thumb_mcp, FFJ3, if_mcp.
std::string_view FingerOfJointName(std::string_view name);
/// mcp, pip, ip, dip or rotation: part of a channel's name. Empty for other words.
std::string_view JointOf(std::string_view word);
/// True for words of sideways motion, as in `index_abduction`.
bool IsSpread(std::string_view word);
/// wrist, forearm, elbow or shoulder; empty for other words.
std::string_view ArmPartOf(std::string_view word);
/// True for the name of a column that tells sessions, trials or other parts of a table apart.
bool NamesParts(std::string_view name);
/// True for words of sensors whose order may be a glove's: flex, sensor, adc, deg ..
bool IsSensorWord(std::string_view word);
/// True for words of positions and joints, which a robot's columns have as well: joint, q, pos ..
bool IsJointWord(std::string_view word);
/// left or right; empty for other words.
std::string_view SideOf(std::string_view word);

}  // namespace gauntlet::sim
