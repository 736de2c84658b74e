#include "sim/inspect/joint_names.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <map>
#include <utility>

#include "sim/base/channels.h"
#include "sim/recordings/time_columns.h"

namespace gauntlet::sim {
namespace {

using Words = std::vector<std::string>;

constexpr std::array<Meaning, 5> kFingers = {
    {{"thumb", "thumb th thm thj"},
     {"index", "index fore forefinger pointer if ff ffj idx"},
     {"middle", "middle mid mf mfj"},
     {"ring", "ring rf rfj"},
     {"little", "little pinky pinkie pink small lf lfj"}}};

constexpr std::array<Meaning, 5> kJoints = {{{"mcp", "mcp mpj knuckle proximal inner near"},
                                             {"pip", "pip pij intermediate"},
                                             {"ip", "ip"},
                                             {"dip", "dip dij distal outer far tip"},
                                             {"rotation", "cmc tmc roll rotation rot opposition"}}};

constexpr std::array<Meaning, 1> kSpreads = {
    {{"spread", "abd abduction adduction abducted spread splay aa"}}};

constexpr std::array<Meaning, 14> kOthers = {
    {{"a quaternion", "quat quaternion qw qx qy qz"},
     {"an acceleration", "acc accel acceleration ax ay az"},
     {"a rate of turn", "gyr gyro gx gy gz"},
     {"a magnetic field", "mag"},
     {"of the motion sensor", "imu"},
     {"an orientation", "pitch yaw"},
     {"a temperature", "temp temperature"},
     {"the battery", "battery"},
     {"a pressure", "pressure"},
     {"a force", "force"},
     {"a muscle's signal", "emg"},
     {"a label", "label gesture class trial subject"},
     {"a number of something", "id"},
     {"a position", "pos"}}};

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

}  // namespace

std::string_view MeaningOf(std::span<const Meaning> list, std::string_view word) {
  const auto found = std::ranges::find_if(
      list, [word](const Meaning& meaning) { return IsWordOf(meaning.words, word); });
  return found == list.end() ? "" : found->means;
}

std::vector<std::string> WordsOf(std::string_view name) {
  enum class Kind { kNone, kUpper, kLower, kDigit };
  Words words;
  Kind before = Kind::kNone;
  for (std::size_t i = 0; i < name.size(); ++i) {
    const auto byte = static_cast<unsigned char>(name[i]);
    Kind kind = Kind::kNone;
    if (std::isupper(byte) != 0) kind = Kind::kUpper;
    if (std::islower(byte) != 0) kind = Kind::kLower;
    if (std::isdigit(byte) != 0) kind = Kind::kDigit;
    const bool next_is_lower =
        i + 1 < name.size() && std::islower(static_cast<unsigned char>(name[i + 1])) != 0;
    const bool begins = kind != before && !(before == Kind::kUpper && kind == Kind::kLower);
    const bool new_word = kind == Kind::kUpper && before == Kind::kUpper && next_is_lower;
    if (kind != Kind::kNone) {
      if (words.empty() || begins || new_word) words.emplace_back();
      words.back().push_back(static_cast<char>(std::tolower(byte)));
    }
    before = kind;
  }
  return words;
}

NamedSensor ReadSensorName(std::string_view name) {
  Words words = WordsOf(name);
  NamedSensor sensor;
  sensor.channel = ChannelOfArm(words);
  if (!sensor.channel.empty()) return sensor;
  int fingers = 0;
  for (const std::string& word : words) {
    const std::string_view finger = MeaningOf(kFingers, word);
    // "index_middle" of a CyberGlove is the middle joint of the index finger.
    if (finger.empty()) continue;
    if (fingers++ == 0) sensor.finger = finger;
  }
  for (const std::string& word : words) {
    if (const std::string_view joint = MeaningOf(kJoints, word); !joint.empty()) {
      sensor.joint = joint;
    }
    sensor.is_spread = sensor.is_spread || !MeaningOf(kSpreads, word).empty();
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
  if (sensor.finger == "thumb" && (sensor.joint == "dip" || sensor.joint == "pip")) {
    sensor.joint = "ip";
  }
  if (sensor.finger != "thumb" && sensor.joint == "ip") sensor.joint = "pip";
  const std::string channel = sensor.finger + "_" + sensor.joint;
  if (IsChannel(channel)) sensor.channel = channel;
  return sensor;
}

std::string NoSensor(std::string_view name) {
  const Words words = WordsOf(name);
  if (!ReadSensorName(name).finger.empty() || !ChannelOfArm(words).empty()) return "";
  for (const std::string& word : words) {
    if (const std::string_view means = MeaningOf(kOthers, word); !means.empty()) {
      return std::string(means);
    }
  }
  return "";
}

std::vector<std::string> ChannelsByNames(const std::vector<std::string>& names,
                                         std::vector<std::string>& why) {
  std::vector<std::string> channels(names.size());
  why.assign(names.size(), "");
  std::map<std::string, std::vector<std::size_t>> only_finger;
  const auto is_taken = [&channels](const std::string& channel) {
    return std::ranges::find(channels, channel) != channels.end();
  };
  for (std::size_t i = 0; i < names.size(); ++i) {
    const NamedSensor sensor = ReadSensorName(names[i]);
    if (sensor.channel.empty()) {
      if (!sensor.finger.empty()) only_finger[sensor.finger].push_back(i);
      continue;
    }
    why[i] = is_taken(sensor.channel) ? sensor.channel + " has a column already" : "by its name";
    if (!is_taken(sensor.channel)) channels[i] = sensor.channel;
  }
  for (const auto& [finger, columns] : only_finger) {
    const std::vector<std::string> joints = ChannelsOfFinger(finger, columns.size());
    for (std::size_t k = 0; k < columns.size(); ++k) {
      const std::string joint = k < joints.size() ? joints[k] : "";
      if (joint.empty() || is_taken(joint)) {
        why[columns[k]] = "no joint of the hand is left for it";
        continue;
      }
      channels[columns[k]] = joint;
      why[columns[k]] =
          fmt::format("sensor {} of {} of this finger (assumption)", k + 1, columns.size());
    }
  }
  return channels;
}

}  // namespace gauntlet::sim
