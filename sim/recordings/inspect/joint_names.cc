#include "sim/recordings/inspect/joint_names.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <map>
#include <utility>

#include "sim/base/channels.h"
#include "sim/tables/name_words.h"
#include "sim/tables/time_columns.h"

namespace gauntlet::sim {
namespace {

using Words = std::vector<std::string>;

bool IsChannel(const std::string& name) {
  return std::ranges::find(KnownChannels(), name, &Channel::name) != KnownChannels().end();
}

/// Channel of the wrist, forearm, elbow or shoulder; empty for other names.
std::string ChannelOfArm(const Words& words) {
  if (HasWordOf(words, "wrist wr")) {
    if (HasWordOf(words, "dev deviation yaw abd abduction ulnar radial")) return "wrist_deviation";
    if (HasWordOf(words, "rotation pronation supination roll")) return "forearm_rotation";
    return "wrist_flexion";
  }
  if (HasWordOf(words, "forearm pronation")) return "forearm_rotation";
  if (HasWordOf(words, "abd abduction adduction pan rotation rot roll yaw horizontal")) return "";
  if (HasWordOf(words, "elbow")) return "elbow_flexion";
  if (HasWordOf(words, "shoulder")) return "shoulder_flexion";
  return "";
}

/// Words beside finger and side: joints, directions, numbers, units.
bool IsWordOfJoint(const std::string& word) {
  const bool is_number = std::isdigit(static_cast<unsigned char>(word.front())) != 0;
  return is_number || !JointOf(word).empty() || IsSensorWord(word) || IsJointWord(word) ||
         IsWordOf(
             "flexion flexed extension stretch curl closure bends angular spreads deviation dev "
             "ulnar radial supination pitch yaw percent pct mv ratio mrad milliradian milliradians",
             word);
}

/// Renames the joints of a thumb with pip and dip, as an export has that names all digits alike:
/// they are those from the root on. False for other thumbs.
bool ShiftLongThumb(std::vector<NamedSensor>& sensors) {
  constexpr std::array<Meaning, 3> kShifted = {
      {{"thumb_rotation", "mcp"}, {"thumb_mcp", "pip"}, {"thumb_ip", "dip"}}};
  const auto has = [&sensors](std::string_view joint) {
    return std::ranges::any_of(sensors, [joint](const NamedSensor& sensor) {
      return sensor.finger == "thumb" && sensor.joint == joint;
    });
  };
  if (!has("pip") || !has("dip")) return false;
  for (NamedSensor& sensor : sensors) {
    const std::string_view shifted = MeaningOf(kShifted, sensor.joint);
    if (sensor.finger == "thumb" && !sensor.is_spread && !shifted.empty()) sensor.channel = shifted;
  }
  return true;
}

}  // namespace

JointName ReadJointName(std::string_view name) {
  JointName joint;
  int fingers = 0;
  const Words words = WordsOf(name);
  for (const std::string& word : words) {
    const bool is_finger = !FingerOf(word).empty();
    const bool is_part = is_finger || !ArmPartOf(word).empty() || IsSpread(word);
    // "index_middle" of a CyberGlove is the middle joint of the index finger.
    fingers += is_finger && (fingers == 0 || word != "middle") ? 1 : 0;
    joint.is_joint = joint.is_joint || is_part;
    if (is_part || IsWordOfJoint(word)) continue;
    if (!SideOf(word).empty()) {
      joint.side = SideOf(word);
      continue;
    }
    joint.other += (joint.other.empty() ? "" : " ") + word;
  }
  if (fingers > 1) joint.other += (joint.other.empty() ? "" : " ") + std::string("pair");
  return joint;
}

NamedSensor ReadSensorName(std::string_view name) {
  Words words = WordsOf(name);
  NamedSensor sensor;
  sensor.channel = ChannelOfArm(words);
  if (!sensor.channel.empty()) return sensor;
  int fingers = 0;
  for (const std::string& word : words) {
    const std::string_view finger = FingerOf(word);
    // "index_middle" of a CyberGlove is the middle joint of the index finger.
    if (!finger.empty() && fingers++ == 0) sensor.finger = finger;
    if (const std::string_view joint = JointOf(word); !joint.empty()) {
      sensor.joint = joint;
    }
    sensor.is_spread = sensor.is_spread || IsSpread(word);
  }
  if (sensor.finger.empty()) {
    if (sensor.is_spread) sensor.channel = "finger_spread";
    return sensor;
  }
  if (sensor.is_spread) {
    sensor.channel = sensor.finger == "thumb" ? "thumb_abduction" : "finger_spread";
    return sensor;
  }
  if (fingers > 1 && sensor.joint.empty()) sensor.joint = "pip";
  const bool is_thumb = sensor.finger == "thumb";
  std::string joint = sensor.joint;
  if (is_thumb && (joint == "dip" || joint == "pip")) joint = "ip";
  if (!is_thumb && joint == "ip") joint = "pip";
  const std::string channel = sensor.finger + "_" + joint;
  if (IsChannel(channel)) sensor.channel = channel;
  return sensor;
}

std::vector<ColumnJoint> JointsByNames(const std::vector<std::string>& names,
                                       std::string& question) {
  std::vector<NamedSensor> sensors;
  for (const std::string& name : names) sensors.push_back(ReadSensorName(name));
  const bool is_shifted = ShiftLongThumb(sensors);
  std::vector<ColumnJoint> joints(names.size());
  std::map<std::string, std::vector<std::size_t>> only_finger;
  std::map<std::string, std::size_t> column_of;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const NamedSensor& sensor = sensors[i];
    if (sensor.channel.empty()) {
      if (HasWordOf(WordsOf(names[i]), "crossover arch")) {
        joints[i].why = "measures no single joint";
      } else if (!sensor.finger.empty()) {
        only_finger[sensor.finger].push_back(i);
      }
      continue;
    }
    const auto [first, is_first] = column_of.try_emplace(sensor.channel, i);
    joints[i].why = is_first ? "by its name" : sensor.channel + " has a column already";
    if (is_first) joints[i].channel = sensor.channel;
    if (is_first && HasWordOf(WordsOf(names[i]), "tip")) {  // or a force, or a place
      joints[i] = {sensor.channel, JointBasis::kAssumed, "the tip of the finger by its name"};
    }
    if (is_first && is_shifted && sensor.finger == "thumb") {
      joints[i] = {sensor.channel, JointBasis::kAssumed,
                   "a thumb with names of a finger: from the root on"};
    }
    if (is_first || sensor.channel == "finger_spread" || !question.empty()) continue;
    question =
        fmt::format("{} and {} both name {}", names[first->second], names[i], sensor.channel);
  }
  for (const auto& [finger, columns] : only_finger) {
    const std::string channel = finger + (finger == "thumb" ? "_ip" : "_pip");
    if (columns.size() > 1 && question.empty()) {
      question = fmt::format("{} and {} are of one finger, and the joint of each is unknown",
                             names[columns[0]], names[columns[1]]);
    }
    const bool is_only = columns.size() == 1 && !column_of.contains(channel);
    ColumnJoint& joint = joints[columns.front()];
    if (is_only) joint = {channel, JointBasis::kAssumed, "the finger by its name"};
  }
  return joints;
}

}  // namespace gauntlet::sim
