#pragma once

#include <yaml-cpp/yaml.h>

#include <filesystem>
#include <functional>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "controller/settings.h"
#include "sim/base/error.h"

namespace gauntlet::sim {

/// What a setting may not be, as the user's mistake at a place.
UserError AtPlace(std::string place, const controller::SettingError& error);

/// Where values come from, for error messages: the file, and what --set put over it.
struct YamlSource {
  std::filesystem::path file;
  std::map<std::string, std::string> overrides;  // path of keys -> text of the --set

  /// `file:line:column` of a node, or `--set text` if an override gave it.
  std::string PlaceOf(const YAML::Node& node, const std::string& path) const;
  /// The error at the place of its node.
  UserError At(const YAML::Node& node, const controller::SettingError& error) const;
};

/// Fills config structs from YAML, strictly: a key that is unknown, given twice, missing though
/// required, of a wrong type, not finite or out of range is a UserError that names its place.
///
/// Two shorthands keep files short: `filter: none` stands for `filter: {kind: none}`, and a single
/// item may stand where a list is expected.
class YamlReader final : public controller::SettingsVisitor {
 public:
  YamlReader(const YAML::Node& node, std::string path, const YamlSource& source);

  void Number(const controller::Setting& setting, double& value) override;
  void Integer(const controller::Setting& setting, int& value) override;
  void Flag(const controller::Setting& setting, bool& value) override;
  void Text(const controller::Setting& setting, std::string& value) override;
  void Path(const controller::Setting& setting, std::string& value) override;
  void Numbers(const controller::Setting& setting, std::vector<double>& value) override;
  void Texts(const controller::Setting& setting, std::vector<std::string>& value) override;
  void Choice(const controller::Setting& setting, std::span<const std::string_view> names,
              std::size_t& index) override;
  void Group(const controller::Setting& setting,
             const std::function<void(controller::SettingsVisitor&)>& visit) override;
  void List(const controller::Setting& setting, const controller::SettingList& list) override;
  void Map(const controller::Setting& setting, const controller::SettingMap& map) override;

  /// To be called after the visit: throws for the first key that nobody asked for.
  void RejectUnknownKeys() const;

 private:
  /// The node of a setting, or an undefined one if the file leaves it out.
  YAML::Node Find(const controller::Setting& setting);
  std::string PathOf(const controller::Setting& setting) const;
  [[noreturn]] void Fail(const YAML::Node& node, const std::string& path,
                         const std::string& problem) const;
  std::string Scalar(const YAML::Node& node, const std::string& path, const char* expected) const;
  double ParseNumber(const YAML::Node& node, const std::string& path,
                     const controller::Setting& setting) const;
  void ReadInside(const YAML::Node& node, const std::string& path,
                  const std::function<void(controller::SettingsVisitor&)>& visit) const;

  YAML::Node node_;
  std::string path_;
  const YamlSource& source_;
  std::vector<std::string> known_keys_;
};

/// Parses a file. Errors: UserError for a syntax error, an unreadable file, or a top level that is
/// not a map.
YAML::Node ParseYamlFile(const std::filesystem::path& file);

/// Puts `key.path=value` over the tree. Errors: UserError for a text that is not an override.
void ApplyOverride(YAML::Node& root, const std::string& text, YamlSource& source);

}  // namespace gauntlet::sim
