#include "sim/settings/yaml_writer.h"

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include <utility>

#include "sim/base/data_folder.h"

namespace gauntlet::sim {
namespace {

using controller::Setting;

class YamlWriter final : public controller::SettingsVisitor {
 public:
  explicit YamlWriter(std::filesystem::path folder) : folder_(std::move(folder)) {}

  void Number(const Setting& setting, double& value) override {
    Key(setting) << YAML::Value << Digits(value);
  }
  void Integer(const Setting& setting, int& value) override {
    Key(setting) << YAML::Value << value;
  }
  void Flag(const Setting& setting, bool& value) override {
    Key(setting) << YAML::Value << (value ? "true" : "false");
  }
  void Text(const Setting& setting, std::string& value) override {
    Key(setting) << YAML::Value << YAML::DoubleQuoted << value;
  }
  void Path(const Setting& setting, std::string& value) override {
    std::string written = PathFrom(folder_, value);
    Text(setting, written);
  }
  void Numbers(const Setting& setting, std::vector<double>& value) override {
    Key(setting) << YAML::Value << YAML::Flow << YAML::BeginSeq;
    for (const double number : value) emitter_ << Digits(number);
    emitter_ << YAML::EndSeq;
  }
  void Texts(const Setting& setting, std::vector<std::string>& value) override {
    Key(setting) << YAML::Value << YAML::Flow << YAML::BeginSeq;
    for (const std::string& text : value) emitter_ << text;
    emitter_ << YAML::EndSeq;
  }
  void Choice(const Setting& setting, std::span<const std::string_view> names,
              std::size_t& index) override {
    Key(setting) << YAML::Value << std::string(names[index]);
  }
  void Group(const Setting& setting,
             const std::function<void(controller::SettingsVisitor&)>& visit) override {
    Key(setting) << YAML::Value << YAML::BeginMap;
    visit(*this);
    emitter_ << YAML::EndMap;
  }
  void List(const Setting& setting, const controller::SettingList& list) override {
    Key(setting) << YAML::Value << YAML::BeginSeq;
    for (std::size_t i = 0; i < list.size(); ++i) {
      emitter_ << YAML::BeginMap;
      list.visit(i, *this);
      emitter_ << YAML::EndMap;
    }
    emitter_ << YAML::EndSeq;
  }
  void Map(const Setting& setting, const controller::SettingMap& map) override {
    if (!map.visit) return;  // of no named groups: its owner writes it
    Key(setting) << YAML::Value << YAML::BeginMap;
    for (std::size_t i = 0; i < map.size(); ++i) {
      emitter_ << YAML::Key << map.name(i) << YAML::Value << YAML::BeginMap;
      map.visit(i, *this);
      emitter_ << YAML::EndMap;
    }
    emitter_ << YAML::EndMap;
  }

  YAML::Emitter& emitter() { return emitter_; }

 private:
  static std::string Digits(double value) { return fmt::format("{}", value); }
  YAML::Emitter& Key(const Setting& setting) {
    return emitter_ << YAML::Key << std::string(setting.key);
  }

  std::filesystem::path folder_;  // of the file that is written; empty: none
  YAML::Emitter emitter_;
};

}  // namespace

std::string SettingsToYaml(const std::function<void(controller::SettingsVisitor&)>& visit,
                           const std::filesystem::path& folder) {
  YamlWriter writer(folder);
  writer.emitter() << YAML::BeginMap;
  visit(writer);
  writer.emitter() << YAML::EndMap;
  return std::string(writer.emitter().c_str()) + "\n";
}

}  // namespace gauntlet::sim
