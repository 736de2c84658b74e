#include "sim/tables/joint_unit.h"

#include <fmt/format.h>

#include <algorithm>
#include <numbers>
#include <vector>

#include "sim/base/text.h"
#include "sim/tables/name_words.h"

namespace gauntlet::sim {
namespace {

constexpr double kTurn_rad = 2.0 * std::numbers::pi * 1.05;

constexpr std::string_view kSlideWords =
    "gripper grip jaw jaws prismatic slide slider sliding rail linear lift";
constexpr std::string_view kWheelWords = "wheel wheels caster steer continuous";

/// `finger_joint1` is a jaw of a gripper; joints of a hand are called `index_finger_joint`,
/// `finger1_joint2` or `finger_spread`.
bool IsJaw(const std::vector<std::string>& words) {
  if (HasWordOf(words, "shoulder")) return false;  // shoulder_lift turns
  if (HasWordOf(words, kSlideWords)) return true;
  for (const std::string& word : words) {
    if (!FingerOf(word).empty()) return false;
  }
  const auto finger = std::ranges::find(words, "finger");
  return finger != words.end() && finger + 1 != words.end() && *(finger + 1) == "joint";
}

/// Value of an attribute within a tag of XML; empty if it has none.
std::string_view AttributeOf(std::string_view tag, std::string_view name) {
  for (std::size_t at = tag.find(name); at != std::string_view::npos; at = tag.find(name, at + 1)) {
    const std::size_t equals = tag.find_first_not_of(" \t\r\n", at + name.size());
    const bool begins =
        at > 0 && std::string_view(" \t\r\n").find(tag[at - 1]) != std::string_view::npos;
    if (!begins || equals == std::string_view::npos || tag[equals] != '=') continue;
    const std::size_t open = tag.find_first_of("\"'", equals);
    if (open == std::string_view::npos) return {};
    const std::size_t close = tag.find(tag[open], open + 1);
    if (close == std::string_view::npos) return {};
    return tag.substr(open + 1, close - open - 1);
  }
  return {};
}

}  // namespace

JointTypes JointTypesIn(std::string_view urdf) {
  JointTypes types;
  constexpr std::string_view kTag = "<joint";
  for (std::size_t at = urdf.find(kTag); at != std::string_view::npos;
       at = urdf.find(kTag, at + 1)) {
    const std::string_view tag = urdf.substr(at, urdf.find('>', at) - at);
    const std::string_view name = AttributeOf(tag, "name");
    const std::string_view type = AttributeOf(tag, "type");
    if (!name.empty() && !type.empty()) types.emplace(name, type);
  }
  return types;
}

JointUnit UnitOfJoint(std::string_view name, double largest, const JointTypes& types) {
  for (const char* end : {"_rad", "_deg", "_m", "_mm"}) {
    if (name.ends_with(end)) return {""};
  }
  const std::string shown = OneLine(std::string(name), 40);
  const auto type = types.find(name);
  if (type != types.end()) {
    if (type->second == "prismatic") {
      return {"_m", fmt::format("{}: metres, as the URDF in the file says (prismatic)", shown)};
    }
    if (type->second == "revolute" || type->second == "continuous") return {"_rad"};
  }
  const std::vector<std::string> words = WordsOf(name);
  if (IsJaw(words)) {
    return {"", fmt::format("{}: radians or metres, unknown (a gripper by its name)", shown)};
  }
  if (largest > kTurn_rad && !HasWordOf(words, kWheelWords)) {
    return {"", fmt::format("{}: up to {:.4g}, beyond a turn in radians, so the unit is unknown",
                            shown, largest)};
  }
  return {"_rad"};
}

}  // namespace gauntlet::sim
