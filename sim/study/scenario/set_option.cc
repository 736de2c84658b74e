#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <string_view>
#include <vector>

#include "controller/filters/filter_config.h"
#include "controller/number.h"
#include "sim/base/error.h"
#include "sim/base/nearest_name.h"
#include "sim/base/text.h"
#include "sim/settings/setting_rows.h"
#include "sim/study/scenario/scenario.h"
#include "sim/study/scenario/scenario_tree.h"

namespace gauntlet::sim {
namespace {

constexpr std::string_view kControllers = "controllers";
constexpr std::size_t kMostPaths = 5;

[[noreturn]] void Fail(const std::string& text, const std::string& key,
                       const std::string& problem) {
  throw UserError({.place = OverridePlace(text), .key = key, .problem = problem});
}

const std::vector<SettingRow>& ScenarioRows() {
  static const std::vector<SettingRow> kRows =
      ListSettings([](controller::SettingsVisitor& visitor) {
        Scenario scenario;
        scenario.Visit(visitor);
      });
  return kRows;
}

std::vector<std::string> ControllerNames(const YamlNode& root) {
  std::vector<std::string> names;
  for (const auto& entry : ChildOf(root, kControllers).entries()) {
    names.push_back(entry.first.text());
  }
  return names;
}

/// True for delay_ms and `delay` as for the same words.
bool IsMeantBy(std::string_view leaf, std::string_view word) {
  return leaf == word || (leaf.starts_with(word) && leaf[word.size()] == '_');
}

/// Those settings of a kind of filter that `word` means.
std::vector<std::string> KeysOfKind(const controller::FilterKind& kind, std::string_view word) {
  auto config = kind.defaults;
  std::vector<std::string> keys;
  for (const SettingRow& row :
       ListSettings([&](controller::SettingsVisitor& visitor) { config.Visit(visitor); })) {
    if (IsMeantBy(row.key, word)) keys.push_back(row.key);
  }
  return keys;
}

/// The whole paths of settings whose last key is `word`, but for its unit: of the scenario and of
/// its controllers' filters; where there are none, what adds a controller that has it.
std::vector<std::string> PathsTo(std::string_view word, const YamlNode& root) {
  std::vector<std::string> paths;
  for (const SettingRow& row : ScenarioRows()) {
    if (IsMeantBy(row.key.substr(row.key.rfind('.') + 1), word)) paths.push_back(row.key);
  }
  std::vector<std::string> added;
  for (const controller::FilterKind& kind : controller::FilterKinds()) {
    for (const std::string& key : KeysOfKind(kind, word)) {
      added.push_back(fmt::format("{}+={}:{}", kControllers, kind.name, key));
      for (const std::string& name : ControllerNames(root)) {
        const YamlNode& filter = NodeAt(root, fmt::format("{}.{}.filter", kControllers, name));
        const YamlNode& named = filter.IsScalar() ? filter : ChildOf(filter, "kind");
        if (named.text() != kind.name) continue;
        paths.push_back(fmt::format("{}.{}.filter.{}", kControllers, name, key));
      }
    }
  }
  return paths.empty() ? added : paths;
}

/// Errors: UserError for a word that is a key, but not of the scenario itself.
void RefuseKeyOfOtherLevel(const YamlNode& root, const std::string& text, const std::string& word) {
  const auto begins = [&](const SettingRow& row) { return IsAtOrBelow(row.key, word); };
  if (word == kControllers || std::ranges::any_of(ScenarioRows(), begins)) return;
  std::vector<std::string> paths = PathsTo(word, root);
  if (paths.empty() || ChildOf(root, word).IsDefined()) return;  // the reader knows more of it
  const std::size_t count = paths.size();
  paths.resize(std::min(count, kMostPaths));
  const std::string more =
      count > kMostPaths ? fmt::format(" and {} more", count - kMostPaths) : std::string();
  Fail(text, word, fmt::format("unknown key (did you mean {}{}?)", fmt::join(paths, ", "), more));
}

/// The value at a path: of the tree, or the default.
double NumberAt(const YamlNode& root, const std::string& text, const std::string& path) {
  const YamlNode& node = NodeAt(root, path);
  std::string value = node.text();
  if (!node.IsScalar()) {  // the tree does not have it
    const auto row = std::ranges::find(ScenarioRows(), path, &SettingRow::key);
    if (row != ScenarioRows().end()) value = row->default_value;
  }
  const auto number = controller::ParseNumber(value);
  if (!number) Fail(text, path, "+= needs a number to add to; give the whole value with =");
  return *number;
}

void AddTo(YamlNode& root, const std::string& text, const std::string& path,
           std::string_view addend, YamlSource& source) {
  const auto number = controller::ParseNumber(addend);
  if (!number) Fail(text, path, fmt::format("is '{}', must be a number", OneLine(addend)));
  const double sum = NumberAt(root, text, path) + *number;
  ApplyOverride(root, fmt::format("{}={}", path, sum), source);
}

/// A name for one more controller of this kind.
std::string FreeName(const std::string& kind, const std::vector<std::string>& names) {
  std::string name = kind;
  for (int i = 2; std::ranges::find(names, name) != names.end(); ++i) {
    name = fmt::format("{}_{}", kind, i);
  }
  return name;
}

/// The comma behind a setting, whose own commas are in brackets.
std::size_t EndOfSetting(std::string_view words, std::size_t begin) {
  int depth = 0;
  std::size_t at = begin;
  for (; at < words.size(); ++at) {
    const char c = words[at];
    if (c == ',' && depth <= 0) break;
    if (c == '[' || c == '{') ++depth;
    if (c == ']' || c == '}') --depth;
  }
  return at;
}

/// A controller with what another program made of the recording.
void AddAnswers(YamlNode& root, const std::string& text, std::string_view file,
                YamlSource& source) {
  std::string name = std::filesystem::path(file).stem().string();
  std::ranges::transform(name, name.begin(), [](unsigned char letter) {
    return std::isalnum(letter) != 0 ? static_cast<char>(std::tolower(letter)) : '_';
  });
  const std::string path =
      fmt::format("{}.{}", kControllers, FreeName(name, ControllerNames(root)));
  const YamlNode filter =
      YamlNode::Map({{YamlNode::Scalar("kind"), YamlNode::Scalar("external")},
                     {YamlNode::Scalar("answers"), YamlNode::Scalar(std::string(file))}});
  PutOver(root, path, YamlNode::Map({{YamlNode::Scalar("filter"), filter}}), OverridePlace(text),
          source);
  source.overrides[path] = text;
}

void AddController(YamlNode& root, const std::string& text, std::string_view words,
                   YamlSource& source) {
  const std::size_t colon = std::min(words.find(':'), words.size());
  const std::string kind(words.substr(0, colon));
  std::vector<std::string> kinds;
  for (const controller::FilterKind& known : controller::FilterKinds()) {
    kinds.emplace_back(known.name);
  }
  if (std::ranges::find(kinds, kind) == kinds.end()) {
    std::error_code none;
    if (std::filesystem::is_regular_file(words, none)) {
      return AddAnswers(root, text, words, source);
    }
    const bool is_file = kind.find_first_of("./") != std::string::npos;
    Fail(text, std::string(kControllers),
         is_file ? "no such file: " + Shown(words)
                 : fmt::format("is no kind of filter: {}{}", Shown(kind), Suggestion(kind, kinds)));
  }
  const std::string name = FreeName(kind, ControllerNames(root));
  const std::string path = fmt::format("{}.{}", kControllers, name);
  const YamlNode filter = YamlNode::Map({{YamlNode::Scalar("kind"), YamlNode::Scalar(kind)}});
  PutOver(root, path, YamlNode::Map({{YamlNode::Scalar("filter"), filter}}), OverridePlace(text),
          source);
  source.overrides[path] = text;
  for (std::size_t begin = colon + 1; begin < words.size();) {
    const std::size_t end = EndOfSetting(words, begin);
    const std::string_view setting = words.substr(begin, end - begin);
    if (setting.find('=') == std::string_view::npos) {
      Fail(text, path, fmt::format("'{}' must be key=value", OneLine(setting)));
    }
    ApplyOverride(root, fmt::format("{}.filter.{}", path, setting), source);
    begin = end + 1;
  }
}

}  // namespace

void ApplySet(YamlNode& root, const std::string& text, YamlSource& source) {
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos || equals == 0) return ApplyOverride(root, text, source);
  if (const std::string path = text.substr(0, equals - 1); text[equals - 1] == '-') {
    Fail(text, path,
         fmt::format("-= is unknown; {}+=-{} takes away", path, text.substr(equals + 1)));
  }
  const bool adds = text[equals - 1] == '+';
  const std::string path = text.substr(0, adds ? equals - 1 : equals);
  RefuseKeyOfOtherLevel(root, text, path.substr(0, path.find_first_of(".[")));
  if (!adds) return ApplyOverride(root, text, source);
  const std::string_view value = std::string_view(text).substr(equals + 1);
  if (path == kControllers) return AddController(root, text, value, source);
  AddTo(root, text, path, value, source);
}

}  // namespace gauntlet::sim
