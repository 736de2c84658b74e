#include "sim/base/channels.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string>

#include "controller/assert.h"
#include "controller/settings.h"
#include "sim/base/error.h"
#include "sim/base/nearest_name.h"
#include "sim/base/text.h"

namespace gauntlet::sim {
namespace {

constexpr std::size_t kDefaults = 18;
constexpr std::array<Channel, 22> kChannels = {{
    {"thumb_rotation", 0, 140, "thumb turned in front of the palm (opposition)"},
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
    {"index_dip", 0, 80, "index finger, end joint; only in gloves that name it"},
    {"middle_dip", 0, 80, "middle finger, end joint; only in gloves that name it"},
    {"ring_dip", 0, 80, "ring finger, end joint; only in gloves that name it"},
    {"little_dip", 0, 80, "little finger, end joint; only in gloves that name it"},
}};

std::vector<std::string> NamesOf(std::span<const Channel> channels) {
  std::vector<std::string> names;
  for (const Channel& channel : channels) names.emplace_back(channel.name);
  return names;
}

}  // namespace

std::span<const Channel> KnownChannels() { return kChannels; }
std::vector<std::string> KnownChannelNames() { return NamesOf(kChannels); }

std::span<const Channel> GloveChannels() { return std::span(kChannels).first(kDefaults); }
std::vector<std::string> GloveChannelNames() { return NamesOf(GloveChannels()); }

int ChannelIndex(std::string_view name) {
  const auto found = std::ranges::find(kChannels, name, &Channel::name);
  if (found != kChannels.end()) return found - kChannels.begin();
  throw UserError(
      fmt::format("unknown channel '{}'{}", Shown(name), Suggestion(name, KnownChannelNames())));
}

std::size_t PlaceInList(std::size_t channel, std::size_t list_size) {
  GAUNTLET_ASSERT(channel < KnownChannels().size());
  if (list_size == 1) return 0;
  if (channel < list_size) return channel;
  const std::string_view name = kChannels.at(channel).name;
  const std::string_view finger = name.substr(0, name.rfind('_'));
  return static_cast<std::size_t>(ChannelIndex(std::string(finger) + "_pip"));
}

void CheckListOfChannels(std::string_view key, std::size_t list_size) {
  if (list_size == 1 || list_size == kDefaults || list_size == kChannels.size()) return;
  throw controller::SettingError(
      std::string(key), fmt::format("has {} values, must have 1 or {}, or {} with the end joints",
                                    list_size, kDefaults, kChannels.size()));
}

}  // namespace gauntlet::sim
