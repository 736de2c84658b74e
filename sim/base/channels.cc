#include "sim/base/channels.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "sim/base/error.h"
#include "sim/base/nearest_name.h"

namespace gauntlet::sim {
namespace {

constexpr std::array<Channel, 18> kChannels = {{
    {"thumb_rotation", 0, 90, "thumb turned in front of the palm (opposition)"},
    {"thumb_abduction", 0, 60, "thumb lifted away from the palm"},
    {"thumb_mcp", 0, 60, "thumb, base joint"},
    {"thumb_ip", -15, 80, "thumb, end joint"},
    {"index_mcp", -45, 90, "index finger, knuckle"},
    {"index_pip", 0, 100, "index finger, middle joint; the end joint follows"},
    {"middle_mcp", -45, 90, "middle finger, knuckle"},
    {"middle_pip", 0, 100, "middle finger, middle joint; the end joint follows"},
    {"ring_mcp", -45, 90, "ring finger, knuckle"},
    {"ring_pip", 0, 100, "ring finger, middle joint; the end joint follows"},
    {"little_mcp", -45, 90, "little finger, knuckle"},
    {"little_pip", 0, 100, "little finger, middle joint; the end joint follows"},
    {"finger_spread", 0, 25, "fingers spread sideways"},
    {"wrist_flexion", -70, 75, "wrist bent to the palm; negative to the back of the hand"},
    {"wrist_deviation", -20, 35, "wrist turned to the little finger; negative to the thumb"},
    {"forearm_rotation", -70, 85, "palm turned up (supination); negative down (pronation)"},
    {"elbow_flexion", 0, 145, "elbow bent"},
    {"shoulder_flexion", -30, 120, "upper arm lifted forward; negative backward"},
}};

}  // namespace

std::span<const Channel> GloveChannels() { return kChannels; }

std::vector<std::string> GloveChannelNames() {
  std::vector<std::string> names;
  for (const Channel& channel : kChannels) names.emplace_back(channel.name);
  return names;
}

int ChannelIndex(std::string_view name) {
  const auto found = std::ranges::find(kChannels, name, &Channel::name);
  if (found != kChannels.end()) return found - kChannels.begin();
  throw UserError(fmt::format("unknown channel '{}'{}", name.substr(0, 60),
                              Suggestion(name, GloveChannelNames())));
}

}  // namespace gauntlet::sim
