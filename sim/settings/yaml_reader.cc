#include "sim/settings/yaml_reader.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "controller/number.h"
#include "sim/base/data_folder.h"
#include "sim/base/nearest_name.h"
#include "sim/base/text.h"

namespace gauntlet::sim {

using controller::RangeProblem;
using controller::Setting;
using controller::SettingError;

YamlReader::YamlReader(const YamlNode& node, std::string path, const YamlSource& source)
    : node_(node), path_(std::move(path)), source_(source) {
  // Shorthand: a lone word stands for the kind of a group whose other settings keep defaults.
  if (node_.IsScalar()) node_ = YamlNode::Map({{YamlNode::Scalar("kind"), node_}});
  if (node_.IsNull()) node_ = YamlNode::Map({});
  if (!node_.IsMap()) Fail(node_, path_, "must be a group of keys, not a list");
  std::set<std::string_view> seen;
  for (const auto& entry : node_.entries()) {
    const std::string& key = Scalar(entry.first, path_, "a key");
    if (!seen.insert(key).second) FailAtKey(entry.first, "is given twice", "has a key twice");
  }
}

void YamlReader::Fail(const YamlNode& node, const std::string& path,
                      const std::string& problem) const {
  throw source_.At(node, SettingError(path, problem));
}

void YamlReader::FailAtKey(const YamlNode& key, const std::string& problem,
                           const std::string& nameless) const {
  const std::string path = PathOf(key.text());
  if (LooksLikeKey(key.text())) throw source_.At(key, SettingError(path, problem));
  throw UserError({.place = source_.PlaceOf(key, path), .key = path_, .problem = nameless});
}

std::string YamlReader::PathOf(std::string_view key) const {
  return path_.empty() ? std::string(key) : fmt::format("{}.{}", path_, key);
}

const YamlNode& YamlReader::Find(const Setting& setting) {
  known_keys_.emplace_back(setting.key);
  const YamlNode& found = ChildOf(node_, setting.key);
  if (setting.required && !found.IsDefined()) missing_.emplace_back(setting.key);
  return found;
}

const std::string& YamlReader::Scalar(const YamlNode& node, const std::string& path,
                                      const char* expected) const {
  if (!node.IsScalar()) Fail(node, path, fmt::format("must be {}", expected));
  return node.text();
}

double YamlReader::ParseNumber(const YamlNode& node, const std::string& path,
                               const Setting& setting) const {
  const std::string& text = Scalar(node, path, "a number");
  const std::optional<double> value = controller::ParseNumber(text);
  if (!value) Fail(node, path, fmt::format("is \"{}\", must be a number", Shown(text)));
  if (const std::string problem = RangeProblem(setting, *value); !problem.empty()) {
    Fail(node, path, problem);
  }
  return *value;
}

void YamlReader::Number(const Setting& setting, double& value) {
  if (const YamlNode& node = Find(setting); node.IsDefined()) {
    value = ParseNumber(node, PathOf(setting.key), setting);
  }
}

void YamlReader::Integer(const Setting& setting, int& value) {
  const YamlNode& node = Find(setting);
  if (!node.IsDefined()) return;
  const double number = ParseNumber(node, PathOf(setting.key), setting);
  if (number != std::floor(number) || std::abs(number) > 2147483647.0) {
    Fail(node, PathOf(setting.key),
         fmt::format("is {}, must be a whole number", Shown(node.text())));
  }
  value = static_cast<int>(number);
}

void YamlReader::Flag(const Setting& setting, bool& value) {
  const YamlNode& node = Find(setting);
  if (!node.IsDefined()) return;
  const std::string text = Scalar(node, PathOf(setting.key), "true or false");
  if (text != "true" && text != "false") {
    Fail(node, PathOf(setting.key), fmt::format("is \"{}\", must be true or false", Shown(text)));
  }
  value = text == "true";
}

void YamlReader::Text(const Setting& setting, std::string& value) {
  const YamlNode& node = Find(setting);
  if (!node.IsDefined()) return;
  value = node.IsNull() ? "" : Scalar(node, PathOf(setting.key), "a text");
  if (const std::string problem = TextProblem(value); !problem.empty()) {
    Fail(node, PathOf(setting.key), problem);
  }
  if (setting.required && value.empty()) Fail(node, PathOf(setting.key), "is empty");
}

void YamlReader::Path(const Setting& setting, std::string& value) {
  const std::string before = value;
  Text(setting, value);
  if (value == before || value.empty()) return;
  const std::filesystem::path base = source_.OverrideOf(PathOf(setting.key)) != nullptr
                                         ? std::filesystem::current_path()
                                         : source_.FileOf(PathOf(setting.key)).parent_path();
  const std::filesystem::path file = std::filesystem::absolute(base / value).lexically_normal();
  std::error_code unreadable;
  value = std::filesystem::exists(file, unreadable) ? file : DataFile(value).value_or(file);
  // The folder that it is relative to has not been looked at, and results name the path.
  if (const std::string problem = TextProblem(value); !problem.empty()) {
    Fail(Find(setting), PathOf(setting.key), fmt::format("{}: the path {}", value, problem));
  }
}

void YamlReader::Numbers(const Setting& setting, std::vector<double>& value) {
  const YamlNode& node = Find(setting);
  if (!node.IsDefined()) return;
  value.clear();
  const std::size_t count = node.IsSequence() ? node.items().size() : 1;
  if (const std::string problem = controller::CountProblem(setting, count); !problem.empty()) {
    Fail(node, PathOf(setting.key), problem);
  }
  if (!node.IsSequence()) {
    value.push_back(ParseNumber(node, PathOf(setting.key), setting));
    return;
  }
  for (std::size_t i = 0; i < node.items().size(); ++i) {
    value.push_back(
        ParseNumber(node.items()[i], fmt::format("{}[{}]", PathOf(setting.key), i), setting));
  }
}

void YamlReader::Texts(const Setting& setting, std::vector<std::string>& value) {
  const YamlNode& node = Find(setting);
  if (!node.IsDefined()) return;
  value.clear();
  if (!node.IsSequence()) {
    value.push_back(Scalar(node, PathOf(setting.key), "a text or a list of texts"));
    return;
  }
  for (std::size_t i = 0; i < node.items().size(); ++i) {
    value.push_back(
        Scalar(node.items()[i], fmt::format("{}[{}]", PathOf(setting.key), i), "a text"));
  }
}

void YamlReader::Choice(const Setting& setting, std::span<const std::string_view> names,
                        std::size_t& index) {
  const YamlNode& node = Find(setting);
  if (!node.IsDefined()) return;
  std::vector<std::string> candidates(names.begin(), names.end());
  std::erase(candidates, "");  // what it is where it is left out
  const std::string text =
      Scalar(node, PathOf(setting.key), fmt::format("{}", fmt::join(candidates, ", ")).c_str());
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (names[i] == text) {
      index = i;
      return;
    }
  }
  Fail(node, PathOf(setting.key),
       fmt::format("is {}, must be one of {}", Shown(text), fmt::join(candidates, ", ")));
}

void YamlReader::ReadInside(const YamlNode& node, const std::string& path,
                            const std::function<void(SettingsVisitor&)>& visit) const {
  YamlReader inner(node, path, source_);
  visit(inner);
  inner.RejectUnknownKeys();
}

void YamlReader::Group(const Setting& setting, const std::function<void(SettingsVisitor&)>& visit) {
  // A group that is left out is still read, so that a missing required key inside is found.
  const YamlNode& node = Find(setting);
  if (!missing_.empty()) return;
  ReadInside(node.IsDefined() ? node : YamlNode::Map({}), PathOf(setting.key), visit);
}

void YamlReader::List(const Setting& setting, const controller::SettingList& list) {
  const YamlNode& node = Find(setting);
  if (!node.IsDefined() || !missing_.empty()) return;
  const bool single = !node.IsSequence();
  list.resize(single ? 1 : node.items().size());
  for (std::size_t i = 0; i < list.size(); ++i) {
    const std::string path =
        single ? PathOf(setting.key) : fmt::format("{}[{}]", PathOf(setting.key), i);
    ReadInside(single ? node : node.items()[i], path,
               [&](SettingsVisitor& inner) { list.visit(i, inner); });
  }
}

void YamlReader::Map(const Setting& setting, const controller::SettingMap& map) {
  const YamlNode& node = Find(setting);
  if (!node.IsDefined() || !missing_.empty()) return;
  if (setting.required && node.entries().empty() && node.items().empty()) {
    Fail(node, PathOf(setting.key), "is empty, must be names with their settings");
  }
  if (!node.IsMap()) Fail(node, PathOf(setting.key), "must be names with their settings");
  std::set<std::string_view> seen;
  for (const auto& entry : node.entries()) {
    const std::string& name = Scalar(entry.first, PathOf(setting.key), "a name");
    const std::string path = PathOf(fmt::format("{}.{}", setting.key, name));
    if (!seen.insert(name).second) Fail(entry.first, path, "is given twice");
    if (name.find_first_not_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ"
                               "0123456789_-+") != std::string::npos) {
      Fail(entry.first, path, "a name has letters, digits, _, - and + only");
    }
    if (const std::string problem = NameProblem(name); !problem.empty()) {
      Fail(entry.first, path, problem);
    }
    map.add(name);
    if (entry.second.IsScalar()) Fail(entry.second, path, "must be a group of keys");
    ReadInside(entry.second, path,
               [&](SettingsVisitor& inner) { map.visit(map.size() - 1, inner); });
  }
}

void YamlReader::NamedNumbers(const Setting& setting,
                              std::vector<controller::NamedNumber>& values) {
  const YamlNode& node = Find(setting);
  if (!node.IsDefined()) return;
  if (!node.IsMap()) Fail(node, PathOf(setting.key), "must be names with a number each");
  values.clear();
  for (const auto& [key, number] : node.entries()) {
    const std::string& name = Scalar(key, PathOf(setting.key), "a name");
    const std::string path = fmt::format("{}.{}", PathOf(setting.key), name);
    if (!LooksLikeKey(name)) {
      Fail(key, PathOf(setting.key), "has a name that is not one of letters, digits, _ and -");
    }
    if (std::ranges::find(values, name, &controller::NamedNumber::name) != values.end()) {
      Fail(key, path, "is given twice");
    }
    values.push_back({.name = name, .value = ParseNumber(number, path, setting)});
  }
}

bool YamlReader::ShowsList(const Setting& setting, bool /*given*/) {
  return ChildOf(node_, setting.key).IsSequence();
}

bool YamlReader::ShowsOptional(const Setting& setting, bool given) {
  return Find(setting).IsDefined() || given;
}

void YamlReader::RejectUnknownKeys() const {
  for (const auto& entry : node_.entries()) {
    const std::string& key = entry.first.text();
    if (std::ranges::find(known_keys_, key) != known_keys_.end()) continue;
    const std::string problem = "unknown key" + Suggestion(key, known_keys_);
    FailAtKey(entry.first, problem, problem);
  }
  if (!missing_.empty()) Fail(node_, PathOf(missing_.front()), "is missing");
}

}  // namespace gauntlet::sim
