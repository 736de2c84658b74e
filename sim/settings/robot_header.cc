#include "sim/settings/robot_header.h"

#include <fmt/format.h>

#include <string_view>

#include "sim/base/text.h"

namespace gauntlet::sim {
namespace {

using controller::Setting;
using controller::SettingsVisitor;

/// A literal of C++. A byte that is not plain text is written in octal, which always has three
/// digits, so that it does not matter what follows.
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

/// Rows of controller::ConstantSetting, as controller::RobotFromConstants() reads them.
class HeaderWriter final : public SettingsVisitor {
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
    for (const double number : value) AddItem(Digits(number));
    EndLine();
  }
  void Texts(const Setting& setting, std::vector<std::string>& value) override {
    AddSize(setting.key, value.size());
    for (const std::string& text : value) AddItem(Literal(text));
    EndLine();
  }
  void Choice(const Setting& setting, std::span<const std::string_view> names,
              std::size_t& index) override {
    Add(setting.key, Literal(names[index]));
  }
  void Group(const Setting& setting, const std::function<void(SettingsVisitor&)>& visit) override {
    AddSize(setting.key, 0);
    visit(*this);
  }
  void List(const Setting& setting, const controller::SettingList& list) override {
    AddSize(setting.key, list.size());
    for (std::size_t i = 0; i < list.size(); ++i) list.visit(i, *this);
  }
  void Map(const Setting& setting, const controller::SettingMap& map) override {
    AddSize(setting.key, map.size());
    for (std::size_t i = 0; i < map.size(); ++i) {
      Add("", Literal(map.name(i)));
      map.visit(i, *this);
    }
  }

  const std::string& text() const { return text_; }

 private:
  static std::string Digits(double value) { return fmt::format("{}", value); }
  void Add(std::string_view key, const std::string& value) {
    text_ += fmt::format("    {{{}, {}}},\n", Literal(key), value);
  }
  void AddSize(std::string_view key, std::size_t size) { Add(key, fmt::format("{}", size)); }
  /// Items of a list share lines.
  void AddItem(const std::string& value) {
    constexpr std::size_t kWidth = 100;
    const std::string item = fmt::format("{{\"\", {}}},", value);
    if (!line_.empty() && line_.size() + 1 + item.size() > kWidth) EndLine();
    line_ += (line_.empty() ? "    " : " ") + item;
  }
  void EndLine() {
    if (!line_.empty()) text_ += line_ + "\n";
    line_.clear();
  }

  std::string text_;
  std::string line_;
};

}  // namespace

std::string RobotToHeader(const controller::RobotConfig& robot, const RobotOrigin& origin) {
  controller::RobotConfig copy = robot;  // a visitor may change what it sees
  HeaderWriter writer;
  copy.Visit(writer);
  return fmt::format(
      R"(// Controller {controller} of scenario {scenario} (hand model {hash}), written by
// gauntlet {version} export. Values have all digits. On the robot (link gauntlet::controller):
//
//   gauntlet::controller::Controller controller(robot::Settings());
//
// and Step() {rate:.6g} times per second, with a new sample of the glove every {every} times.
#pragma once

#include "controller/constant_settings.h"

namespace robot {{

inline constexpr int kChannelCount = {channels};
inline constexpr int kMotorCount = {motors};
inline constexpr double kTickRateHz = {exact_rate};
inline constexpr int kTicksPerSample = {every};

inline constexpr gauntlet::controller::ConstantSetting kSettings[] = {{
{settings}}};

inline gauntlet::controller::RobotConfig Settings() {{
  return gauntlet::controller::RobotFromConstants(kSettings);
}}

}}  // namespace robot
)",
      fmt::arg("controller", OneLine(origin.controller)),
      fmt::arg("scenario", OneLine(origin.scenario)), fmt::arg("hash", origin.model_hash),
      fmt::arg("version", origin.gauntlet_version), fmt::arg("rate", robot.timing.tick_rate_hz),
      fmt::arg("exact_rate", robot.timing.tick_rate_hz),
      fmt::arg("every", robot.timing.ticks_per_sample),
      fmt::arg("channels", robot.glove.channel_names.size()),
      fmt::arg("motors", robot.hand.motor_names.size()), fmt::arg("settings", writer.text()));
}

}  // namespace gauntlet::sim
