#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace gauntlet::sim {

/// One bending sensor of the glove and the wearer's joint below it.
struct Channel {
  std::string_view name;
  double min_deg;  // range of the human joint, positive is flexion
  double max_deg;
  std::string_view help;
};

/// All channels that a glove can have, in the order of the data: the 18 that it has by default,
/// then the end joints of the four fingers. Ranges: see docs/explanation/glove.md.
std::span<const Channel> KnownChannels();
std::vector<std::string> KnownChannelNames();
/// The 18 that a glove has by default, as in the paper: the first of KnownChannels().
std::span<const Channel> GloveChannels();
std::vector<std::string> GloveChannelNames();
/// Index in KnownChannels(); throws UserError with the nearest name if there is none.
int ChannelIndex(std::string_view name);

/// Angle of a finger's end joint per angle of its middle joint while the end joint is not bent on
/// its own. Source: Rijpkema and Girard, Computer Animation of Knowledge-Based Human Grasping,
/// SIGGRAPH 1991.
inline constexpr double kEndJointPerMiddleJoint = 2.0 / 3.0;

/// Index of a channel's value in a list of settings. The list has one value for all channels, one
/// per channel of GloveChannels(), or one per channel of KnownChannels(). In the second case an end
/// joint takes the value of its finger's middle joint.
std::size_t PlaceInList(std::size_t channel, std::size_t list_size);
/// Errors: SettingError of `key` for a list of any other size.
void CheckListOfChannels(std::string_view key, std::size_t list_size);

}  // namespace gauntlet::sim
