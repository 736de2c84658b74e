#include "sim/scenario/included_controllers.h"

#include <map>
#include <string>

#include "sim/base/error.h"

namespace gauntlet::sim {
namespace {

/// Errors: UserError for an !include in this tree, at its place.
void RefuseIncludes(const YAML::Node& node, const std::string& path, const YamlSource& source) {
  if (node.IsScalar() && node.Tag() == kIncludeTag) {
    throw source.At(node, controller::SettingError(path, std::string(kMisplacedInclude)));
  }
  if (node.IsSequence()) {
    for (std::size_t i = 0; i < node.size(); ++i) {
      RefuseIncludes(node[i], path + "[" + std::to_string(i) + "]", source);
    }
  }
  if (!node.IsMap()) return;
  for (const auto& entry : node) {
    const std::string key = entry.first.IsScalar() ? entry.first.Scalar() : "";
    RefuseIncludes(entry.second, path.empty() ? key : path + "." + key, source);
  }
}

YAML::Node ReadIncluded(const std::filesystem::path& file, const YAML::Node& where,
                        const std::string& key, const YamlSource& source) {
  std::string text;
  try {
    text = ReadYamlText(file);
  } catch (const UserError& error) {
    throw source.At(where, controller::SettingError(key, std::string("!include ") + error.what()));
  }
  return ParseYaml(file, text);
}

}  // namespace

void IncludeControllers(YAML::Node& root, YamlSource& source) {
  const YAML::Node controllers = NodeAt(root, "controllers");
  std::map<std::string, std::string> included;  // controller -> file as it is written
  for (const auto& entry : root) {
    const bool are_controllers = entry.second.is(controllers) && controllers.IsMap();
    if (!are_controllers) RefuseIncludes(entry.second, entry.first.Scalar(), source);
  }
  if (!controllers.IsMap() || controllers.is(root)) return;
  for (const auto& entry : controllers) {
    const YAML::Node& value = entry.second;
    if (value.IsScalar() && value.Tag() == kIncludeTag && entry.first.IsScalar()) {
      included[entry.first.Scalar()] = value.Scalar();
    } else {
      RefuseIncludes(value, "controllers." + entry.first.Scalar(), source);
    }
  }
  std::map<std::filesystem::path, YAML::Node> trees;
  for (const auto& [name, written] : included) {
    YAML::Node value = controllers[name];
    const std::string key = "controllers." + name;
    if (written.empty()) {
      throw source.At(value, controller::SettingError(key, "!include names no file"));
    }
    const std::filesystem::path file = source.file.parent_path() / written;
    if (!trees.contains(file)) trees[file] = ReadIncluded(file, value, key, source);
    source.included[key] = file;
    YAML::Node list = controllers;
    list[name] = trees[file];
  }
}

}  // namespace gauntlet::sim
