#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "controller/settings.h"
#include "sim/settings/yaml_tree.h"

namespace gauntlet::sim {

/// Fills config structs from YAML, strictly: a key that is unknown, given twice, missing though
/// required, of a wrong type, not finite or out of range is a UserError that names its place.
///
/// Two shorthands keep files short: `filter: none` stands for `filter: {kind: none}`, and a single
/// item may stand where a list is expected.
///
/// A path is relative to the file that is read, or, where that has no such file, the name of one
/// that Gauntlet brings along (`scenarios/recordings/a.csv`).
class YamlReader final : public controller::SettingsVisitor {
 public:
  YamlReader(const YamlNode& node, std::string path, const YamlSource& source);

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
  void NamedNumbers(const controller::Setting& setting,
                    std::vector<controller::NamedNumber>& values) override;
  bool ShowsOptional(const controller::Setting& setting, bool given) override;
  bool ShowsList(const controller::Setting& setting, bool given) override;

  /// To be called after the visit: throws for the first key that was not read, then for the
  /// first that is required and missing: so one that is only misspelt is said to be so.
  void RejectUnknownKeys() const;

 private:
  /// The node of a setting, or an undefined one if the file leaves it out.
  const YamlNode& Find(const controller::Setting& setting);
  std::string PathOf(std::string_view key) const;
  [[noreturn]] void Fail(const YamlNode& node, const std::string& path,
                         const std::string& problem) const;
  /// About a key that may not be there: by its name, or `nameless` where none may be repeated.
  [[noreturn]] void FailAtKey(const YamlNode& key, const std::string& problem,
                              const std::string& nameless) const;
  const std::string& Scalar(const YamlNode& node, const std::string& path,
                            const char* expected) const;
  double ParseNumber(const YamlNode& node, const std::string& path,
                     const controller::Setting& setting) const;
  void ReadInside(const YamlNode& node, const std::string& path,
                  const std::function<void(controller::SettingsVisitor&)>& visit) const;

  YamlNode node_;
  std::string path_;
  const YamlSource& source_;
  std::vector<std::string> known_keys_;
  std::vector<std::string> missing_;  // with one, groups are not read: only its place is still open
};

/// All that a tree says, and it must say nothing else.
template <class Settings>
void ReadAll(const YamlNode& root, const YamlSource& source, Settings& settings) {
  YamlReader reader(root, "", source);
  settings.Visit(reader);
  reader.RejectUnknownKeys();
}
/// Settings from a file.
template <class Settings>
Settings ReadAll(const std::filesystem::path& file) {
  Settings settings;
  ReadAll(ParseYamlFile(file), {.file = file}, settings);
  return settings;
}

}  // namespace gauntlet::sim
