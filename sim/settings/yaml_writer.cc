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
  YamlWriter(std::filesystem::path folder, bool for_people)
      : folder_(std::move(folder)), for_people_(for_people) {}

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
    Title(setting) << YAML::Value;
    if (for_people_ && depth_ == 2) emitter_ << YAML::Flow;
    emitter_ << YAML::BeginMap;
    ++depth_;
    visit(*this);
    --depth_;
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
    Title(setting) << YAML::Value << YAML::BeginMap;
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

  /// The key of a group. For people with its help: above a section of the file, behind a group of
  /// a section.
  YAML::Emitter& Title(const Setting& setting) {
    const auto help = YAML::Comment(std::string(setting.help));
    if (for_people_ && depth_ == 0) {
      if (emitter_.size() > 0) emitter_ << YAML::Newline;
      emitter_ << YAML::Newline << help;
    }
    Key(setting);
    if (for_people_ && depth_ == 1) emitter_ << help;
    return emitter_;
  }

  std::filesystem::path folder_;  // of the file that is written; empty: none
  bool for_people_;
  int depth_ = 0;  // of groups
  YAML::Emitter emitter_;
};

std::string Written(const std::function<void(controller::SettingsVisitor&)>& visit,
                    YamlWriter writer) {
  writer.emitter() << YAML::BeginMap;
  visit(writer);
  writer.emitter() << YAML::EndMap;
  return std::string(writer.emitter().c_str()) + "\n";
}

}  // namespace

std::string SettingsToYaml(const std::function<void(controller::SettingsVisitor&)>& visit,
                           const std::filesystem::path& folder) {
  return Written(visit, YamlWriter(folder, false));
}

std::string SettingsToYamlForPeople(
    const std::function<void(controller::SettingsVisitor&)>& visit) {
  return Written(visit, YamlWriter({}, true));
}

}  // namespace gauntlet::sim
