#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace gauntlet::sim {

/// What the name of a column says about the wearer's hand.
struct NamedSensor {
  std::string finger = {};   // thumb, index, middle, ring or little; empty: none is named
  std::string joint = {};    // a part of a channel's name, as mcp; empty: none is named
  bool is_spread = false;    // between fingers
  std::string channel = {};  // what they make together; empty: it takes all columns to tell
};

/// Small words of a name: `IndexPIP_deg2` is index, pip, deg, 2.
std::vector<std::string> WordsOf(std::string_view name);

NamedSensor ReadSensorName(std::string_view name);

/// What this column is, if by its name it is no sensor of the hand: "a quaternion".
std::string NoSensor(std::string_view name);

/// Channels for columns by their names; empty where a name says nothing, or what another has said
/// before. `why` gets a reason for each.
std::vector<std::string> ChannelsByNames(const std::vector<std::string>& names,
                                         std::vector<std::string>& why);

}  // namespace gauntlet::sim
