#include "sim/settings/yaml_reader.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "sim/base/nearest_name.h"

namespace gauntlet::sim {

using controller::RangeProblem;
using controller::Setting;
using controller::SettingError;

UserError AtPlace(std::string place, const SettingError& error) {
  return UserError({.place = std::move(place), .key = error.key(), .problem = error.problem()});
}

std::string YamlSource::PlaceOf(const YAML::Node& node, const std::string& path) const {
  for (const auto& [key, text] : overrides) {
    const bool covers = path == key || path.starts_with(key + ".") || path.starts_with(key + "[");
    if (covers) return "--set " + text;
  }
  const YAML::Mark mark = node.Mark();
  if (mark.is_null()) {  // made on the way to what an override sets
    for (const auto& [key, text] : overrides) {
      if (key.starts_with(path + ".")) return "--set " + text;
    }
    return file.string();
  }
  return fmt::format("{}:{}:{}", file.string(), mark.line + 1, mark.column + 1);
}

UserError YamlSource::At(const YAML::Node& node, const SettingError& error) const {
  return AtPlace(PlaceOf(node, error.key()), error);
}

YamlReader::YamlReader(const YAML::Node& node, std::string path, const YamlSource& source)
    : node_(node), path_(std::move(path)), source_(source) {
  // Shorthand: a lone word stands for the kind of a group whose other settings keep defaults.
  if (node_.IsScalar()) {
    YAML::Node group(YAML::NodeType::Map);
    group["kind"] = node_;
    node_ = group;
  }
  if (node_.IsNull()) node_ = YAML::Node(YAML::NodeType::Map);
  if (!node_.IsMap()) Fail(node_, path_, "must be a group of keys, not a list");
  std::set<std::string> seen;
  for (const auto& entry : node_) {
    const std::string key = Scalar(entry.first, path_, "a key");
    if (!seen.insert(key).second) {
      Fail(entry.first, path_.empty() ? key : path_ + "." + key, "is given twice");
    }
  }
}

void YamlReader::Fail(const YAML::Node& node, const std::string& path,
                      const std::string& problem) const {
  throw source_.At(node, SettingError(path, problem));
}

std::string YamlReader::PathOf(const Setting& setting) const {
  return path_.empty() ? std::string(setting.key) : fmt::format("{}.{}", path_, setting.key);
}

YAML::Node YamlReader::Find(const Setting& setting) {
  known_keys_.emplace_back(setting.key);
  for (const auto& entry : node_) {
    if (entry.first.Scalar() == setting.key) return entry.second;
  }
  if (setting.required) Fail(node_, PathOf(setting), "is missing");
  return YAML::Node(YAML::NodeType::Undefined);
}

std::string YamlReader::Scalar(const YAML::Node& node, const std::string& path,
                               const char* expected) const {
  if (!node.IsScalar()) Fail(node, path, fmt::format("must be {}", expected));
  return node.Scalar();
}

double YamlReader::ParseNumber(const YAML::Node& node, const std::string& path,
                               const Setting& setting) const {
  const std::string text = Scalar(node, path, "a number");
  double value = 0.0;
  const char* begin = text.c_str() + (text.starts_with('+') ? 1 : 0);
  const char* end = text.c_str() + text.size();
  const auto [rest, error] = std::from_chars(begin, end, value);
  if (text == ".nan" || text == ".inf" || text == "-.inf" || text == "+.inf")
    value = NAN;
  else if (error != std::errc() || rest != end) {
    Fail(node, path, fmt::format("is \"{}\", must be a number", text));
  }
  if (!std::isfinite(value)) Fail(node, path, fmt::format("is {}, must be finite", text));
  if (const std::string problem = RangeProblem(setting, value); !problem.empty()) {
    Fail(node, path, problem);
  }
  return value;
}

void YamlReader::Number(const Setting& setting, double& value) {
  if (const YAML::Node node = Find(setting); node.IsDefined()) {
    value = ParseNumber(node, PathOf(setting), setting);
  }
}

void YamlReader::Integer(const Setting& setting, int& value) {
  const YAML::Node node = Find(setting);
  if (!node.IsDefined()) return;
  const double number = ParseNumber(node, PathOf(setting), setting);
  if (number != std::floor(number) || std::abs(number) > 2147483647.0) {
    Fail(node, PathOf(setting), fmt::format("is {}, must be a whole number", node.Scalar()));
  }
  value = static_cast<int>(number);
}

void YamlReader::Flag(const Setting& setting, bool& value) {
  const YAML::Node node = Find(setting);
  if (!node.IsDefined()) return;
  const std::string text = Scalar(node, PathOf(setting), "true or false");
  if (text != "true" && text != "false") {
    Fail(node, PathOf(setting), fmt::format("is \"{}\", must be true or false", text));
  }
  value = text == "true";
}

void YamlReader::Text(const Setting& setting, std::string& value) {
  const YAML::Node node = Find(setting);
  if (!node.IsDefined()) return;
  value = Scalar(node, PathOf(setting), "a text");
  if (setting.required && value.empty()) Fail(node, PathOf(setting), "is empty");
}

void YamlReader::Path(const Setting& setting, std::string& value) {
  const std::string before = value;
  Text(setting, value);
  if (value == before || value.empty()) return;
  const bool from_command_line = source_.overrides.contains(PathOf(setting));
  const std::filesystem::path base =
      from_command_line ? std::filesystem::current_path() : source_.file.parent_path();
  value = std::filesystem::absolute(base / value).lexically_normal().string();
}

void YamlReader::Numbers(const Setting& setting, std::vector<double>& value) {
  const YAML::Node node = Find(setting);
  if (!node.IsDefined()) return;
  value.clear();
  const std::size_t count = node.IsSequence() ? node.size() : 1;
  if (const std::string problem = controller::CountProblem(setting, count); !problem.empty()) {
    Fail(node, PathOf(setting), problem);
  }
  if (!node.IsSequence()) {
    value.push_back(ParseNumber(node, PathOf(setting), setting));
    return;
  }
  for (std::size_t i = 0; i < node.size(); ++i) {
    value.push_back(ParseNumber(node[i], fmt::format("{}[{}]", PathOf(setting), i), setting));
  }
}

void YamlReader::Texts(const Setting& setting, std::vector<std::string>& value) {
  const YAML::Node node = Find(setting);
  if (!node.IsDefined()) return;
  value.clear();
  if (!node.IsSequence()) {
    value.push_back(Scalar(node, PathOf(setting), "a text or a list of texts"));
    return;
  }
  for (std::size_t i = 0; i < node.size(); ++i) {
    value.push_back(Scalar(node[i], fmt::format("{}[{}]", PathOf(setting), i), "a text"));
  }
}

void YamlReader::Choice(const Setting& setting, std::span<const std::string_view> names,
                        std::size_t& index) {
  const YAML::Node node = Find(setting);
  if (!node.IsDefined()) return;
  const std::vector<std::string> candidates(names.begin(), names.end());
  const std::string text =
      Scalar(node, PathOf(setting), fmt::format("{}", fmt::join(candidates, ", ")).c_str());
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (names[i] == text) {
      index = i;
      return;
    }
  }
  Fail(node, PathOf(setting),
       fmt::format("is {}, must be one of {}", text, fmt::join(candidates, ", ")));
}

void YamlReader::ReadInside(const YAML::Node& node, const std::string& path,
                            const std::function<void(SettingsVisitor&)>& visit) const {
  YamlReader inner(node, path, source_);
  visit(inner);
  inner.RejectUnknownKeys();
}

void YamlReader::Group(const Setting& setting, const std::function<void(SettingsVisitor&)>& visit) {
  // A group that is left out is still read, so that a missing required key inside is found.
  YAML::Node node = Find(setting);
  if (!node.IsDefined()) node = YAML::Node(YAML::NodeType::Map);
  ReadInside(node, PathOf(setting), visit);
}

void YamlReader::List(const Setting& setting, const controller::SettingList& list) {
  const YAML::Node node = Find(setting);
  if (!node.IsDefined()) return;
  const bool single = !node.IsSequence();
  list.resize(single ? 1 : node.size());
  for (std::size_t i = 0; i < list.size(); ++i) {
    const std::string path = single ? PathOf(setting) : fmt::format("{}[{}]", PathOf(setting), i);
    ReadInside(single ? node : node[i], path,
               [&](SettingsVisitor& inner) { list.visit(i, inner); });
  }
}

void YamlReader::Map(const Setting& setting, const controller::SettingMap& map) {
  const YAML::Node node = Find(setting);
  if (!node.IsDefined()) return;
  if (setting.required && (!node.IsMap() || node.size() == 0)) {
    Fail(node, PathOf(setting), "is empty, must be names with their settings");
  }
  if (!node.IsMap()) Fail(node, PathOf(setting), "must be names with their settings");
  std::set<std::string> seen;
  for (const auto& entry : node) {
    const std::string name = Scalar(entry.first, PathOf(setting), "a name");
    const std::string path = fmt::format("{}.{}", PathOf(setting), name);
    if (!seen.insert(name).second) Fail(entry.first, path, "is given twice");
    if (name.empty() || name.find_first_not_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUV"
                                               "WXYZ0123456789_-+") != std::string::npos) {
      Fail(entry.first, path, "a name has letters, digits, _, - and + only");
    }
    map.add(name);
    if (entry.second.IsScalar()) Fail(entry.second, path, "must be a group of keys");
    ReadInside(entry.second, path,
               [&](SettingsVisitor& inner) { map.visit(map.size() - 1, inner); });
  }
}

void YamlReader::RejectUnknownKeys() const {
  for (const auto& entry : node_) {
    const std::string key = entry.first.Scalar();
    if (std::find(known_keys_.begin(), known_keys_.end(), key) != known_keys_.end()) continue;
    const std::string path = path_.empty() ? key : path_ + "." + key;
    Fail(entry.first, path, "unknown key" + Suggestion(key, known_keys_));
  }
}

YAML::Node ParseYamlFile(const std::filesystem::path& file) {
  std::error_code error;
  if (!std::filesystem::exists(file, error)) {
    throw UserError({.place = file.string(), .problem = "no such file"});
  }
  if (std::filesystem::is_directory(file, error)) {
    throw UserError({.place = file.string(), .problem = "is a folder, must be a scenario file"});
  }
  try {
    YAML::Node root = YAML::LoadFile(file.string());
    if (!root.IsMap()) {
      throw UserError({.place = file.string() + ":1:1", .problem = "must be a map of keys"});
    }
    return root;
  } catch (const YAML::BadFile&) {
    throw UserError({.place = file.string(), .problem = "cannot be read"});
  } catch (const YAML::Exception& problem) {
    throw UserError({.place = fmt::format("{}:{}:{}", file.string(), problem.mark.line + 1,
                                          problem.mark.column + 1),
                     .problem = problem.msg});
  }
}

namespace {

std::vector<std::string> SplitPath(const std::string& path) {
  std::vector<std::string> keys(1);
  for (const char c : path) {
    if (c == '.') {
      keys.emplace_back();
    } else {
      keys.back() += c;
    }
  }
  return keys;
}

/// The node below `parent` that `key` names, made if needed; follows the reader's shorthands.
YAML::Node Descend(YAML::Node parent, const std::string& key) {
  if (parent.IsScalar()) {
    const std::string kind = parent.Scalar();
    parent = YAML::Node(YAML::NodeType::Map);
    parent["kind"] = kind;
  }
  if (parent.IsSequence()) {
    std::size_t index = 0;
    const auto [rest, error] = std::from_chars(key.data(), key.data() + key.size(), index);
    if (error == std::errc() && rest == key.data() + key.size() && index < parent.size()) {
      return parent[index];
    }
    if (parent.size() == 1) return Descend(parent[0], key);
  }
  for (const auto& entry : parent) {
    if (entry.first.IsScalar() && entry.first.Scalar() == key) return entry.second;
  }
  return parent[key];
}

/// An override may change a controller but not invent one: a misspelt name would only add a row.
void RejectUnknownController(const YAML::Node& root, const std::string& text,
                             const std::vector<std::string>& keys) {
  if (keys.size() < 2 || keys[0] != "controllers") return;
  std::vector<std::string> names;
  for (const auto& entry : root["controllers"]) names.push_back(entry.first.Scalar());
  if (std::find(names.begin(), names.end(), keys[1]) != names.end()) return;
  throw UserError({.place = "--set " + text,
                   .key = "controllers." + keys[1],
                   .problem = "unknown controller" + Suggestion(keys[1], names)});
}

}  // namespace

void ApplyOverride(YAML::Node& root, const std::string& text, YamlSource& source) {
  const auto fail = [&text](const std::string& problem) {
    throw UserError({.place = "--set " + text, .problem = problem});
  };
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos || equals == 0) fail("must be key.path=value");
  const std::string path = text.substr(0, equals);
  RejectUnknownController(root, text, SplitPath(path));
  YAML::Node node = root;
  for (const std::string& key : SplitPath(path)) {
    if (key.empty()) fail("has an empty key");
    if (node.IsSequence() && node.size() != 1 &&
        key.find_first_not_of("0123456789") != std::string::npos) {
      fail(key + " is a list, name an item by its number");
    }
    node.reset(Descend(node, key));
  }
  try {
    node = YAML::Load(text.substr(equals + 1));
  } catch (const YAML::Exception& problem) {
    fail(problem.msg);
  }
  source.overrides[path] = text;
}

}  // namespace gauntlet::sim
