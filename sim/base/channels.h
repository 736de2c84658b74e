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

/// The 18 channels of the glove, in the order of the data. Ranges: see sim/glove/README.md.
std::span<const Channel> GloveChannels();
std::vector<std::string> GloveChannelNames();
/// Index of a channel; throws UserError with the nearest name if there is none.
int ChannelIndex(std::string_view name);

}  // namespace gauntlet::sim
