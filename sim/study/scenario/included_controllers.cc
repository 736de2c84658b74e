#include <map>
#include <string>
#include <vector>

#include "sim/base/error.h"
#include "sim/study/scenario/scenario_tree.h"

namespace gauntlet::sim {
namespace {

/// Errors: UserError for an !include in this tree, at its place.
void RefuseIncludes(const YamlNode& node, const std::string& path, const YamlSource& source) {
  if (node.IsScalar() && node.tag() == kIncludeTag) {
    throw source.At(node, controller::SettingError(path, std::string(kMisplacedInclude)));
  }
  if (node.IsSequence()) {
    for (std::size_t i = 0; i < node.items().size(); ++i) {
      RefuseIncludes(node.items()[i], path + "[" + std::to_string(i) + "]", source);
    }
  }
  for (const auto& entry : node.entries()) {
    const std::string& key = entry.first.text();
    RefuseIncludes(entry.second, path.empty() ? key : path + "." + key, source);
  }
}

YamlNode ReadIncluded(const std::filesystem::path& file, const YamlNode& where,
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

void IncludeControllers(YamlNode& root, YamlSource& source) {
  const YamlNode controllers = ChildOf(root, "controllers");
  const auto is_include = [](const YamlNode& value) {
    return value.IsScalar() && value.tag() == kIncludeTag;
  };
  for (const auto& [key, value] : root.entries()) {
    if (!value.Is(controllers) || !controllers.IsMap()) RefuseIncludes(value, key.text(), source);
  }
  for (const auto& [name, value] : controllers.entries()) {
    if (!is_include(value)) RefuseIncludes(value, "controllers." + name.text(), source);
  }
  std::map<std::filesystem::path, YamlNode> trees;
  std::vector<YamlNode::Entry> entries = controllers.entries();
  for (auto& [name, value] : entries) {
    if (!is_include(value)) continue;
    const std::string key = "controllers." + name.text();
    if (value.text().empty()) {
      throw source.At(value, controller::SettingError(key, "!include names no file"));
    }
    const std::filesystem::path file = source.file.parent_path() / value.text();
    if (!trees.contains(file)) trees[file] = ReadIncluded(file, value, key, source);
    source.included[key] = file;
    value = trees[file];
  }
  if (trees.empty()) return;
  root = WithChild(root, "controllers", YamlNode::Map(std::move(entries), controllers.place()));
}

}  // namespace gauntlet::sim
