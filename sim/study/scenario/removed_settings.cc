#include <fmt/format.h>

#include <algorithm>
#include <string_view>
#include <vector>

#include "sim/base/error.h"
#include "sim/study/scenario/scenario_tree.h"

namespace gauntlet::sim {
namespace {

struct RemovedSetting {
  std::string_view group;  // path of keys
  std::string_view key;
  std::vector<std::string_view> without_effect;  // values; none: each is
  std::string_view instead;
};

const std::vector<RemovedSetting>& RemovedSettings() {
  static const std::vector<RemovedSetting> kSettings = {
      {"glove.tremor", "shared_percent", {"50"}, "channels share half of the tremor's power"},
      {"glove.sensor", "low_percent", {"10"}, "give the counts of your glove by a column map"},
      {"glove.sensor", "high_percent", {"90"}, "give the counts of your glove by a column map"},
      {"glove.noise", "recording", {""}, "measure its variances by gauntlet calibrate"},
      {"glove.noise", "recording_map", {""}, "measure its variances by gauntlet calibrate"},
      {"glove.noise", "recording_rate_hz", {}, ""},
      {"glove.noise", "recording_problems", {}, ""},
      {"glove.noise", "recording_longest_gap_ms", {}, ""},
      {"glove.noise", "recording_smoothing_hz", {}, ""},
      {"glove.noise", "recording_scale", {}, ""},
      {"link.glove", "duplicates_percent", {}, ""},
      {"link.glove", "clock_offset_ms", {}, ""},
      {"link.hand", "duplicates_percent", {}, ""},
      {"link.hand", "clock_offset_ms", {}, ""},
      {"link.glove", "reorders", {"false"}, "frames arrive in the order in which they were sent"},
      {"link.glove", "clock_drift_ppm", {"0"}, "the clocks of a link run alike"},
      {"link.hand", "reorders", {"false"}, "frames arrive in the order in which they were sent"},
      {"link.hand", "clock_drift_ppm", {"0"}, "the clocks of a link run alike"},
      {"event",
       "jitter_ms",
       {"0"},
       "use link.hand.delay: {kind: gamma, mean_ms: 5, deviation_ms: 5}"},
      {"event", "loss_percent", {"0"}, "use link.hand.loss: {kind: independent, percent: 1}"},
      {"glove.sensor", "hysteresis_deviation_percent", {"20"}, "it is always 20"},
      {"glove.sensor", "lag_deviation_percent", {"20"}, "it is always 20"},
      {"glove.noise", "walk_counts_per_sqrt_s", {"0"}, "use glove.noise.pink_variance_counts2"},
      {"hand.cable", "stretch", {"true"}, "use hand.cable.stiffness_scale: 8"},
      {"hand.cable", "interference", {"true"}, "cables move the joints that they cross"},
      {"hand.wear", "slack_mm_per_hour", {"0", "[0]"}, "compare values of hand.cable.slack_mm"},
      {"hand.wear", "slack_mm_per_km", {"0", "[0]"}, "compare values of hand.cable.slack_mm"},
      {"hand.wear.snap", "cable", {""}, "cables do not snap any more"},
      {"hand.wear.snap", "at_s", {}, ""},
  };
  return kSettings;
}

/// Groups that hold nothing but removed settings, inner ones first.
constexpr std::string_view kRemovedGroups[] = {"hand.wear.snap", "hand.wear"};

/// Undefined where the tree has no such path.
YamlNode GroupAt(const YamlNode& root, std::string_view path) {
  const std::size_t dot = path.find('.');
  const YamlNode& child = ChildOf(root, path.substr(0, dot));
  return dot == std::string_view::npos ? child : GroupAt(child, path.substr(dot + 1));
}

std::string TextOf(const YamlNode& value) {
  if (!value.IsSequence()) return value.text();
  return value.items().size() == 1 ? fmt::format("[{}]", value.items().front().text()) : "..";
}

/// The tree with another node at the end of a path that it has.
YamlNode Replaced(const YamlNode& root, std::string_view path, const YamlNode& node) {
  const std::size_t dot = path.find('.');
  const std::string_view key = path.substr(0, dot);
  if (dot == std::string_view::npos) return WithChild(root, key, node);
  return WithChild(root, key, Replaced(ChildOf(root, key), path.substr(dot + 1), node));
}

YamlNode Without(const RemovedSetting& setting, const YamlSource& source, const YamlNode& group) {
  const YamlNode& value = ChildOf(group, setting.key);
  if (!value.IsDefined()) return group;
  const std::string text = TextOf(value);
  const bool has_effect =
      !setting.without_effect.empty() && std::ranges::count(setting.without_effect, text) == 0;
  if (has_effect) {
    const std::string key = fmt::format("{}.{}", setting.group, setting.key);
    throw source.At(
        value, controller::SettingError(key, fmt::format("is {}, but this setting was removed: {}",
                                                         text, setting.instead)));
  }
  return WithoutChild(group, setting.key);
}

/// A motion, and those that a sequence consists of. Fingers of a grasp start 15 ms apart, those of
/// other motions together.
YamlNode WithoutFingerLag(const YamlSource& source, const YamlNode& motion) {
  const bool is_grasp = ChildOf(motion, "kind").text() == "grasp";
  const RemovedSetting lag = {"glove.motion",
                              "finger_lag_ms",
                              {is_grasp ? "15" : "0"},
                              is_grasp ? "it is always 15" : "it is always 0"};
  YamlNode without = Without(lag, source, motion);
  const YamlNode& parts = ChildOf(without, "parts");
  if (!parts.IsSequence()) return without;
  std::vector<YamlNode> items;
  for (const YamlNode& part : parts.items()) items.push_back(WithoutFingerLag(source, part));
  return WithChild(without, "parts", YamlNode::Sequence(std::move(items), parts.place()));
}

}  // namespace

void LeaveOutRemovedSettings(const YamlSource& source, YamlNode& root) {
  for (const RemovedSetting& setting : RemovedSettings()) {
    const YamlNode group = GroupAt(root, setting.group);
    if (!group.IsMap()) continue;
    root = Replaced(root, setting.group, Without(setting, source, group));
  }
  if (const YamlNode motion = GroupAt(root, "glove.motion"); motion.IsMap()) {
    root = Replaced(root, "glove.motion", WithoutFingerLag(source, motion));
  }
  for (const std::string_view path : kRemovedGroups) {
    const std::size_t dot = path.rfind('.');
    const YamlNode outer = GroupAt(root, path.substr(0, dot));
    const YamlNode& group = ChildOf(outer, path.substr(dot + 1));
    if (!group.IsMap() || !group.entries().empty()) continue;
    root = Replaced(root, path.substr(0, dot), WithoutChild(outer, path.substr(dot + 1)));
  }
}

}  // namespace gauntlet::sim
