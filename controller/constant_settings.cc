#include "controller/constant_settings.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

namespace gauntlet::controller {
namespace {

class ConstantReader final : public SettingsVisitor {
 public:
  explicit ConstantReader(std::span<const ConstantSetting> settings) : settings_(settings) {}

  void Number(const Setting& setting, double& value) override { value = Next(setting.key).number; }
  void Integer(const Setting& setting, int& value) override {
    value = static_cast<int>(std::lround(Next(setting.key).number));
  }
  void Flag(const Setting& setting, bool& value) override {
    value = Next(setting.key).number != 0.0;
  }
  void Text(const Setting& setting, std::string& value) override { value = Next(setting.key).text; }
  void Path(const Setting& setting, std::string& value) override { Text(setting, value); }
  void Numbers(const Setting& setting, std::vector<double>& value) override {
    value.resize(Size(setting.key));
    for (double& number : value) number = Next("").number;
  }
  void Texts(const Setting& setting, std::vector<std::string>& value) override {
    value.resize(Size(setting.key));
    for (std::string& text : value) text = Next("").text;
  }
  void Choice(const Setting& setting, std::span<const std::string_view> names,
              std::size_t& index) override {
    const std::string_view name = Next(setting.key).text;
    const auto found = std::ranges::find(names, name);
    if (found == names.end()) Fail(setting.key, "has no choice " + std::string(name));
    index = static_cast<std::size_t>(found - names.begin());
  }
  void Group(const Setting& setting, const std::function<void(SettingsVisitor&)>& visit) override {
    Next(setting.key);
    visit(*this);
  }
  void List(const Setting& setting, const SettingList& list) override {
    const std::size_t size = Size(setting.key);
    list.resize(size);
    for (std::size_t i = 0; i < size; ++i) list.visit(i, *this);
  }
  void Map(const Setting& setting, const SettingMap& map) override {
    const std::size_t size = Size(setting.key);
    for (std::size_t i = 0; i < size; ++i) {
      map.add(std::string(Next("").text));
      map.visit(i, *this);
    }
  }

  void ExpectEnd() const {
    if (place_ < settings_.size()) Fail(settings_[place_].key, "is one setting too many");
  }

 private:
  [[noreturn]] static void Fail(std::string_view key, const std::string& problem) {
    throw SettingError(std::string(key),
                       problem + " in this version of the controller: export the settings again");
  }
  const ConstantSetting& Next(std::string_view key) {
    if (place_ == settings_.size()) Fail(key, "is missing");
    if (settings_[place_].key != key) {
      Fail(key, "stands where the constants have " + std::string(settings_[place_].key));
    }
    return settings_[place_++];
  }
  std::size_t Size(std::string_view key) {
    return static_cast<std::size_t>(std::max(Next(key).number, 0.0));
  }

  std::span<const ConstantSetting> settings_;
  std::size_t place_ = 0;
};

}  // namespace

RobotConfig RobotFromConstants(std::span<const ConstantSetting> settings) {
  RobotConfig robot;
  ConstantReader reader(settings);
  robot.Visit(reader);
  reader.ExpectEnd();
  return robot;
}

}  // namespace gauntlet::controller
