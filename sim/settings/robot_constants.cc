#include "sim/settings/robot_constants.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cstddef>
#include <string_view>
#include <vector>

#include "controller/embedded/embedded_settings.h"
#include "sim/base/text.h"

namespace gauntlet::sim {
namespace {

using controller::Setting;
using controller::SettingsVisitor;

/// A literal of C++ and of RobotFromText(). A byte that is not plain text is written in octal,
/// which always has three digits, so that it does not matter what follows.
std::string Literal(std::string_view text) {
  std::string literal = "\"";
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\' || c == '?') {
      literal += {'\\', c};
    } else if (byte < 0x20 || byte > 0x7e) {
      literal += fmt::format("\\{:03o}", byte);
    } else {
      literal += c;
    }
  }
  return literal + "\"";
}

/// A setting as it is written.
struct Row {
  enum Role { kValue, kGroup, kItem };
  std::string key;
  std::string value;
  int depth = 0;  // of the groups around it
  Role role = kValue;
};

/// The rows in the order in which controller::RobotFromText() reads them.
class RowWriter final : public SettingsVisitor {
 public:
  void Number(const Setting& setting, double& value) override { Add(setting.key, Digits(value)); }
  void Integer(const Setting& setting, int& value) override {
    Add(setting.key, fmt::format("{}", value));
  }
  void Flag(const Setting& setting, bool& value) override { Add(setting.key, value ? "1" : "0"); }
  void Text(const Setting& setting, std::string& value) override {
    Add(setting.key, Literal(value));
  }
  void Path(const Setting& setting, std::string& value) override { Text(setting, value); }
  void Numbers(const Setting& setting, std::vector<double>& value) override {
    AddSize(setting.key, value.size());
    for (const double number : value) Add("", Digits(number), Row::kItem);
  }
  void Texts(const Setting& setting, std::vector<std::string>& value) override {
    AddSize(setting.key, value.size());
    for (const std::string& text : value) Add("", Literal(text), Row::kItem);
  }
  void Choice(const Setting& setting, std::span<const std::string_view> names,
              std::size_t& index) override {
    Add(setting.key, Literal(names[index]));
  }
  void Group(const Setting& setting, const std::function<void(SettingsVisitor&)>& visit) override {
    Add(setting.key, "0", Row::kGroup);
    Inside([&] { visit(*this); });
  }
  void List(const Setting& setting, const controller::SettingList& list) override {
    AddSize(setting.key, list.size());
    for (std::size_t i = 0; i < list.size(); ++i) Inside([&] { list.visit(i, *this); });
  }
  void Map(const Setting& setting, const controller::SettingMap& map) override {
    AddSize(setting.key, map.size());
    for (std::size_t i = 0; i < map.size(); ++i) {
      Inside([&] {
        Add("", Literal(map.name(i)));
        Inside([&] { map.visit(i, *this); });
      });
    }
  }

  const std::vector<Row>& rows() const { return rows_; }

 private:
  static std::string Digits(double value) { return fmt::format("{}", value); }
  void Add(std::string_view key, std::string value, Row::Role role = Row::kValue) {
    rows_.push_back({std::string(key), std::move(value), depth_, role});
  }
  void AddSize(std::string_view key, std::size_t size) { Add(key, fmt::format("{}", size)); }
  void Inside(const std::function<void()>& visit) {
    ++depth_;
    visit();
    --depth_;
  }

  std::vector<Row> rows_;
  int depth_ = 0;
};

std::vector<Row> RowsOf(controller::RobotConfig robot) {  // by value: a visitor may change it
  RowWriter writer;
  robot.Visit(writer);
  return writer.rows();
}

/// A setting a line, behind two blanks for each group around it.
std::string AsText(const std::vector<Row>& rows) {
  std::string text;
  for (const Row& row : rows) {
    if (row.role == Row::kItem) {
      text += " " + row.value;
      continue;
    }
    const bool plain = std::ranges::all_of(
        row.key, [](unsigned char c) { return std::isalnum(c) != 0 || c == '_'; });
    if (!text.empty()) text += "\n";
    text += std::string(2 * static_cast<std::size_t>(row.depth), ' ');
    text += (plain ? row.key : Literal(row.key)) + (row.key.empty() ? "=" : " =");
    if (row.role == Row::kValue) text += " " + row.value;
  }
  return text + "\n";
}

std::string EmbeddedLiteral(controller::EmbeddedValue::Type type, double value) {
  using controller::EmbeddedValue;
  if (type == EmbeddedValue::kFlag) return value != 0.0 ? "true" : "false";
  if (type == EmbeddedValue::kInteger) return fmt::format("{:.0f}", value);
  const std::string digits = fmt::format("{}", static_cast<float>(value));
  return digits + (digits.find_first_of(".e") == std::string::npos ? ".0F" : "F");
}

/// Values in braces, wrapped.
std::string EmbeddedRow(const controller::EmbeddedValue& member, std::size_t begin,
                        std::size_t end) {
  constexpr std::size_t kWidth = 90;
  std::string text = "{";
  std::size_t line = 0;
  for (std::size_t i = begin; i < end; ++i) {
    if (i > begin) {
      const bool wraps = text.size() - line > kWidth;
      text += wraps ? ",\n         " : ", ";
      if (wraps) line = text.size();
    }
    text += EmbeddedLiteral(member.type, member.values[i]);
  }
  return text + "}";
}

std::string EmbeddedMember(const controller::EmbeddedValue& member) {
  std::string text = fmt::format("    .{} = ", member.name);
  const std::size_t count = member.values.size();
  if (!member.is_list) {
    text += EmbeddedLiteral(member.type, member.values[0]);
  } else if (member.columns == 0) {
    text += "{\n        " + EmbeddedRow(member, 0, count).substr(1);
  } else {
    for (std::size_t i = 0; i < count; i += member.columns) {
      text += (i == 0 ? "{\n        " : ",\n        ") + EmbeddedRow(member, i, i + member.columns);
    }
    text += "}";
  }
  return text + ",\n";
}

/// Two headers can be in one program: each has a namespace of its own, which needs no mention where
/// there is one header.
std::string NamespaceOf(const RobotOrigin& origin) {
  std::string name;
  for (const std::string& part : {origin.scenario, origin.controller}) {
    if (!name.empty() && name.back() != '_') name += '_';
    for (const unsigned char c : part) {
      const bool plain = c < 0x80 && std::isalnum(c) != 0;
      if (plain || (!name.empty() && name.back() != '_'))
        name += plain ? static_cast<char>(c) : '_';
    }
  }
  return "of_" + name;
}

}  // namespace

std::string TicksPerSampleText(const controller::Timing& timing) {
  if (timing.glove_rate_hz == 0.0) return fmt::format("{}", timing.ticks_per_sample);
  return fmt::format("{:.4g}", timing.tick_rate_hz / timing.glove_rate_hz);
}

std::string RobotToText(const controller::RobotConfig& robot, const RobotOrigin& origin) {
  return fmt::format(
             R"(# Controller {} of scenario {} (hand model {}), written by
# gauntlet {} export. Values have all digits and may be changed, and lines left out; their order may not.
# For gauntlet_controller_create() (controller/c_api/gauntlet_controller.h), then
# gauntlet_controller_step() {:.6g} times per second, with a new sample of the glove every {} times.
)",
             OneLine(origin.controller), OneLine(origin.scenario), origin.model_hash,
             origin.gauntlet_version, robot.timing.tick_rate_hz, TicksPerSampleText(robot.timing)) +
         AsText(RowsOf(robot));
}

std::string RobotToEmbeddedHeader(const controller::RobotConfig& robot, const RobotOrigin& origin) {
  const controller::EmbeddedSettings settings = controller::EmbeddedSettingsOf(robot);
  std::string members;
  std::string_view group;
  for (const controller::EmbeddedValue& member : settings.values) {
    if (member.group != group) members += fmt::format("    .{} = {{\n", member.group);
    group = member.group;
    members += EmbeddedMember(member);
  }
  if (!group.empty()) members += "    },\n";
  return fmt::format(
      R"(// Controller {controller} of scenario {scenario} (hand model {hash}), written by
// gauntlet {version} export, for a microcontroller: C++20, no library.
//
//   static robot::Controller controller(robot::kSettings);
//
// and Step() {rate:.6g} times per second, with a new sample of the glove every {fresh} times.
#pragma once

#include "controller/embedded/embedded_controller.h"

namespace robot {{
inline namespace {name} {{

inline constexpr int kChannelCount = {channels};
inline constexpr int kMotorCount = {motors};
inline constexpr int kTicksPerSample = {every};
inline constexpr gauntlet::embedded::Settings<{channels}, {joints}, {motors}, {corners}, {steps}> kSettings = {{
{members}}};

using Controller = gauntlet::embedded::Controller<{channels}, {joints}, {motors}, {corners}, {steps}>;

}}  // namespace {name}
}}  // namespace robot
)",
      fmt::arg("name", NamespaceOf(origin)), fmt::arg("controller", OneLine(origin.controller)),
      fmt::arg("scenario", OneLine(origin.scenario)), fmt::arg("hash", origin.model_hash),
      fmt::arg("version", origin.gauntlet_version), fmt::arg("rate", robot.timing.tick_rate_hz),
      fmt::arg("every", robot.timing.ticks_per_sample),
      fmt::arg("fresh", TicksPerSampleText(robot.timing)),
      fmt::arg("channels", robot.glove.channel_names.size()),
      fmt::arg("joints", robot.hand.joint_names.size()),
      fmt::arg("motors", robot.hand.motor_names.size()), fmt::arg("corners", settings.corner_count),
      fmt::arg("steps", settings.step_count), fmt::arg("members", members));
}

}  // namespace gauntlet::sim
