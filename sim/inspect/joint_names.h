#pragma once

#include <span>
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

/// A meaning, and the words that have it, with blanks between them.
struct Meaning {
  std::string_view means;
  std::string_view words;
};
/// The meaning of a word; empty if the list has none.
std::string_view MeaningOf(std::span<const Meaning> list, std::string_view word);

/// Words of a name in lower case: `IndexPIP_deg2` is index, pip, deg, 2.
std::vector<std::string> WordsOf(std::string_view name);

NamedSensor ReadSensorName(std::string_view name);

/// Kind of a column that by its name is no sensor of the hand: "a quaternion". Empty for others.
std::string NoSensor(std::string_view name);

/// Channels of columns by their names; empty if the name has no joint, or its channel is taken by
/// an earlier column. `why` receives a reason for each column.
std::vector<std::string> ChannelsByNames(const std::vector<std::string>& names,
                                         std::vector<std::string>& why);

}  // namespace gauntlet::sim
