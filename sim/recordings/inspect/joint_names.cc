#include "sim/recordings/inspect/joint_names.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <map>
#include <utility>

#include "controller/number.h"
#include "sim/base/channels.h"
#include "sim/tables/name_words.h"
#include "sim/tables/time_columns.h"

namespace gauntlet::sim {
namespace {

using Words = std::vector<std::string>;

bool Has(const Words& words, std::string_view word) {
  return std::ranges::find(words, word) != words.end();
}

bool IsChannel(const std::string& name) {
  return std::ranges::find(KnownChannels(), name, &Channel::name) != KnownChannels().end();
}

/// Channel of the wrist, forearm, elbow or shoulder; empty for other names.
std::string ChannelOfArm(const Words& words) {
  if (Has(words, "wrist") || Has(words, "wr")) {
    for (const char* word : {"dev", "deviation", "yaw", "abd", "abduction", "ulnar", "radial"}) {
      if (Has(words, word)) return "wrist_deviation";
    }
    for (const char* word : {"rotation", "pronation", "supination", "roll"}) {
      if (Has(words, word)) return "forearm_rotation";
    }
    return "wrist_flexion";
  }
  if (Has(words, "forearm") || Has(words, "pronation")) return "forearm_rotation";
  if (HasWordOf(words, "abd abduction adduction pan rotation rot roll yaw horizontal")) return "";
  if (Has(words, "elbow")) return "elbow_flexion";
  if (Has(words, "shoulder")) return "shoulder_flexion";
  return "";
}

/// Channels of a finger for this number of sensors without a joint in their names.
std::vector<std::string> ChannelsOfFinger(const std::string& finger, std::size_t sensors) {
  if (finger == "thumb") {
    if (sensors == 1) return {"thumb_ip"};
    if (sensors == 2) return {"thumb_mcp", "thumb_ip"};
    if (sensors == 3) return {"thumb_rotation", "thumb_mcp", "thumb_ip"};
    if (sensors == 4) return {"thumb_rotation", "thumb_abduction", "thumb_mcp", "thumb_ip"};
    return {"thumb_rotation", "thumb_abduction", "", "thumb_mcp", "thumb_ip"};
  }
  if (sensors == 1) return {finger + "_pip"};
  if (sensors == 2) return {finger + "_mcp", finger + "_pip"};
  if (sensors == 3) return {finger + "_mcp", finger + "_pip", finger + "_dip"};
  // The sensors before these three measure sideways motion and the palm bone.
  std::vector<std::string> channels(sensors - 3);
  for (const char* joint : {"_mcp", "_pip", "_dip"}) channels.push_back(finger + joint);
  return channels;
}

/// Words beside finger and side: joints, directions, numbers, units.
bool IsWordOfJoint(const std::string& word) {
  const bool is_number = std::isdigit(static_cast<unsigned char>(word.front())) != 0;
  return is_number || !JointOf(word).empty() || IsSensorWord(word) || IsJointWord(word) ||
         IsWordOf(
             "flexion flexed extension stretch curl bends angular spreads deviation dev ulnar "
             "radial supination pitch yaw percent pct mv ratio",
             word);
}

/// A thumb with sensors at mcp, pip and dip: an export with the same names for all fingers. Its
/// three joints are those from the root on.
bool ShiftLongThumb(const std::vector<NamedSensor>& sensors, std::vector<ColumnJoint>& joints) {
  std::map<std::string, std::size_t> column_of;
  for (std::size_t i = 0; i < sensors.size(); ++i) {
    if (sensors[i].finger == "thumb" && !sensors[i].is_spread) {
      column_of.try_emplace(sensors[i].joint, i);
    }
  }
  if (!column_of.contains("pip") || !column_of.contains("dip")) return false;
  const std::pair<const char*, const char*> shifted[] = {
      {"mcp", "thumb_rotation"}, {"pip", "thumb_mcp"}, {"dip", "thumb_ip"}};
  for (const auto& [joint, channel] : shifted) {
    if (!column_of.contains(joint)) continue;
    joints[column_of.at(joint)] = {channel, JointBasis::kAssumed,
                                   "a thumb with names of a finger: from the root on"};
  }
  return true;
}

/// The last number in a name, 0 without one.
double NumberIn(const std::string& name) {
  double number = 0.0;
  for (const std::string& word : WordsOf(name)) {
    number = controller::ParseNumber(word).value_or(number);
  }
  return number;
}

/// Sensors of one finger without a joint in their names, in the order of their numbers. Those of a
/// Shadow hand (FFJ3) are numbered from the tip.
void ShareOut(const std::string& finger, std::vector<std::size_t> columns,
              const std::vector<std::string>& names, std::vector<ColumnJoint>& joints) {
  std::ranges::stable_sort(columns, {}, [&](std::size_t c) { return NumberIn(names[c]); });
  if (HasWordOf(WordsOf(names[columns.front()]), "thj ffj mfj rfj lfj")) {
    std::ranges::reverse(columns);
  }
  const std::vector<std::string> channels = ChannelsOfFinger(finger, columns.size());
  for (std::size_t k = 0; k < columns.size(); ++k) {
    ColumnJoint& joint = joints[columns[k]];
    const bool is_taken = std::ranges::any_of(joints, [&](const ColumnJoint& other) {
      return k < channels.size() && !channels[k].empty() && other.channel == channels[k];
    });
    if (k >= channels.size() || channels[k].empty() || is_taken) {
      joint.why = "no joint of the hand is left for it";
      continue;
    }
    joint = {channels[k], JointBasis::kAssumed,
             fmt::format("the finger by its name; sensor {} of {} of it", k + 1, columns.size())};
  }
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
    if (finger.empty()) continue;
    if (fingers++ == 0) sensor.finger = finger;
  }
  for (const std::string& word : words) {
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
  std::vector<ColumnJoint> joints(names.size());
  const bool has_long_thumb = ShiftLongThumb(sensors, joints);
  std::map<std::string, std::vector<std::size_t>> only_finger;
  std::map<std::string, std::size_t> column_of;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const NamedSensor& sensor = sensors[i];
    if (has_long_thumb && sensor.finger == "thumb" && !joints[i].channel.empty()) continue;
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
    if (is_first || sensor.channel == "finger_spread" || !question.empty()) continue;
    question =
        fmt::format("{} and {} both name {}", names[first->second], names[i], sensor.channel);
  }
  for (const auto& [finger, columns] : only_finger) ShareOut(finger, columns, names, joints);
  return joints;
}

}  // namespace gauntlet::sim
