#include "sim/glove/motions/postures.h"

#include <fmt/format.h>

#include <algorithm>
#include <string>

#include "controller/assert.h"
#include "controller/settings.h"
#include "sim/base/channels.h"
#include "sim/base/nearest_name.h"
#include "sim/base/signal.h"

namespace gauntlet::sim {
namespace {

constexpr std::array<Posture, 11> kPostures = {{
    // thumb: rotation, abduction, MCP, IP; index, middle, ring, little: MCP, PIP; spread; wrist
    // flexion, deviation; forearm rotation; elbow; shoulder. In precision and tripod the pads are
    // 8 to 13 mm apart, as on a thing of that size; a search kept all digits apart on the way from
    // open, with all variations of a grasp.
    {"rest",
     "the hand hangs relaxed",
     {30, 20, 15, 10, 20, 25, 22, 28, 25, 30, 28, 32, 5, 10, 5, 0, 80, 20}},
    {"open",
     "all fingers straight and spread",
     {20, 45, 0, 0, -5, 2, -5, 2, -5, 2, -5, 2, 18, -10, 0, 0, 80, 20}},
    {"power",
     "fingers and thumb around a bottle",
     {64, 41, 25, 40, 60, 75, 62, 78, 65, 80, 68, 80, 1, -20, 10, 0, 85, 25}},
    {"precision",
     "tips of thumb and index finger on a small thing",
     {104, 38, 0, -11, 55, 14, 25, 30, 20, 25, 20, 25, 0, -15, 5, 20, 90, 25}},
    {"tripod",
     "thumb, index and middle finger around a pen",
     {106, 49, 0, -7, 70, 8, 46, 42, 35, 55, 35, 55, 0, -20, 5, -15, 90, 20}},
    {"lateral",
     "thumb on the side of the index finger, as on a key",
     {20, 10, 20, 30, 55, 70, 60, 80, 60, 80, 60, 80, 2, -10, 5, 45, 90, 20}},
    {"hook",
     "a bag on the bent fingers, the thumb away",
     {15, 15, 5, 5, 5, 85, 5, 88, 5, 88, 5, 85, 4, 0, 0, 0, 20, 0}},
    {"point",
     "index finger straight, the others closed",
     {60, 30, 35, 45, 0, 5, 70, 85, 72, 88, 72, 85, 3, 0, 0, -20, 60, 40}},
    {"around_bottle",
     "the open hand around a bottle that stands in front of the palm, fingers and thumb up",
     {72, 60, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, -20, 0, 28, 75}},
    {"grip_bottle",
     "fingers and thumb pressed on that bottle",
     {70, 50, 37, 45, 54, 67, 73, 69, 77, 62, 77, 60, 0, 0, -20, 0, 28, 75}},
    {"lift_bottle",
     "the same, the elbow bent by 20 deg more",
     {70, 50, 37, 45, 54, 67, 73, 69, 77, 62, 77, 60, 0, 0, -20, 0, 48, 75}},
}};

constexpr auto kNames = [] {
  std::array<std::string_view, kPostures.size()> names;
  for (std::size_t i = 0; i < names.size(); ++i) names[i] = kPostures[i].name;
  return names;
}();

}  // namespace

std::span<const Posture> Postures() { return kPostures; }
std::span<const std::string_view> PostureNames() { return kNames; }

std::size_t PostureIndex(std::string_view name) {
  const auto found = std::ranges::find(kNames, name);
  if (found != kNames.end()) return static_cast<std::size_t>(found - kNames.begin());
  throw controller::SettingError(
      "postures",
      fmt::format("unknown posture '{}'{}", name.substr(0, 60),
                  Suggestion(name, std::vector<std::string>(kNames.begin(), kNames.end()))));
}

void BendEndJoints(std::vector<double>& angle_rad) {
  GAUNTLET_ASSERT(angle_rad.size() >= GloveChannels().size());
  const std::size_t first = GloveChannels().size();
  angle_rad.resize(KnownChannels().size());
  for (std::size_t channel = first; channel < angle_rad.size(); ++channel) {
    angle_rad[channel] = kEndJointPerMiddleJoint * angle_rad[PlaceInList(channel, first)];
  }
}

std::vector<double> PostureAngles(std::size_t index) {
  std::vector<double> angles;
  for (const double angle_deg : kPostures.at(index).angle_deg) {
    angles.push_back(angle_deg * kRadPerDeg);
  }
  BendEndJoints(angles);
  return angles;
}

}  // namespace gauntlet::sim
