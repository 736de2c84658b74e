#include "sim/scenario/scenario_reader.h"

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cctype>
#include <map>

#include "sim/base/error.h"
#include "sim/base/nearest_name.h"
#include "sim/base/text.h"
#include "sim/scenario/controller_defaults.h"
#include "sim/scenario/included_controllers.h"
#include "sim/settings/yaml_reader.h"
#include "sim/settings/yaml_tree.h"

namespace gauntlet::sim {
namespace {

/// Names become those of folders and files, also where case makes no difference.
void CheckNames(const YAML::Node& root, const YamlSource& source, const Scenario& scenario) {
  if (const std::string problem = NameProblem(scenario.name); !problem.empty()) {
    const YAML::Node given = ChildOf(root, "name");
    if (given.IsDefined()) throw source.At(given, controller::SettingError("name", problem));
    throw UserError({.place = source.file.string(),
                     .key = "name",
                     .problem = fmt::format(
                         "must be given, as the file's name cannot be one: it {}", problem)});
  }
  std::map<std::string, std::string> seen;  // in small letters -> as given
  for (const NamedController& named : scenario.controllers) {
    std::string small = named.name;
    std::ranges::transform(small, small.begin(), [](unsigned char c) { return std::tolower(c); });
    const auto [other, is_new] = seen.insert({small, named.name});
    if (is_new) continue;
    throw source.At(
        NodeAt(root, "controllers." + named.name),
        controller::SettingError(
            "controllers." + named.name,
            fmt::format("differs from {} by case only, which not all file systems tell apart",
                        other->second)));
  }
}

void CheckBaseline(const YAML::Node& root, const YamlSource& source, const Scenario& scenario) {
  if (scenario.baseline.empty()) return;
  std::vector<std::string> names;
  for (const NamedController& named : scenario.controllers) names.push_back(named.name);
  if (std::ranges::find(names, scenario.baseline) != names.end()) return;
  throw UserError({.place = source.PlaceOf(ChildOf(root, "baseline"), "baseline"),
                   .key = "baseline",
                   .problem = Shown(scenario.baseline) + " is not a controller of the scenario" +
                              Suggestion(scenario.baseline, names)});
}

void CheckVideoSize(const YAML::Node& root, const YamlSource& source, const VideoConfig& video) {
  for (const auto& [key, side_px] :
       {std::pair{"width_px", video.width_px}, std::pair{"height_px", video.height_px}}) {
    if (side_px % 2 == 0) continue;
    throw source.At(ChildOf(ChildOf(root, "video"), key),
                    controller::SettingError(std::string("video.") + key,
                                             fmt::format("is {}, must be even", side_px)));
  }
}

using RepeatedSettings = std::vector<RepeatedSetting>;

/// The file, the values of one repetition, then what --set puts over both: single values, then
/// those of lists.
YamlSource TreeOf(const ScenarioSource& text, const RepeatedSettings& lists, std::size_t repetition,
                  YAML::Node& root) {
  root.reset(ParseYaml(text.file, text.text, YamlIncludes::kAllowed));
  YamlSource source{.file = text.file};
  IncludeControllers(root, source);
  PutRepetition(lists, repetition, ListsFrom::kFile, root, source);
  for (const std::string& override : text.overrides) ApplyOverride(root, override, source);
  PutRepetition(lists, repetition, ListsFrom::kSet, root, source);
  return source;
}

/// The tree of the first repetition, and what the others have in place of it.
RepeatedSettings FirstTreeOf(const ScenarioSource& text, YAML::Node& root, YamlSource& source) {
  source = TreeOf(text, {}, 0, root);
  RepeatedSettings lists = ReadRepetitions(root, source);
  if (!lists.empty()) source = TreeOf(text, lists, 0, root);
  return lists;
}

/// What the tree of one repetition says.
Scenario ReadScenario(const ScenarioSource& text, const RepeatedSettings& lists,
                      std::size_t repetition, YAML::Node& root, const YamlSource& source) {
  RemoveRepetitions(root);
  Scenario scenario;
  scenario.name = text.file.stem().string();
  try {
    ReadAll(root, source, scenario);
  } catch (const UserError& error) {
    const auto list = std::ranges::find(lists, error.key(), &RepeatedSetting::key);
    if (list == lists.end()) throw;
    throw source.At(list->values[repetition],
                    controller::SettingError(error.key(), error.problem()));
  }
  return scenario;
}

/// The gloves of all repetitions; `scenario` is of the first. They begin with the one that the
/// scenario's seed has in the file.
Repetitions AllRepetitions(const ScenarioSource& text, const RepeatedSettings& lists,
                           const YamlSource& source, const Scenario& scenario) {
  Repetitions repetitions;
  if (lists.empty()) return repetitions;
  for (const RepeatedSetting& list : lists) repetitions.keys.push_back(list.key);
  repetitions.gloves.push_back(scenario.glove);
  for (std::size_t i = 1; i < lists.front().values.size(); ++i) {
    YAML::Node root;
    const YamlSource of_this = TreeOf(text, lists, i, root);
    TakeAutoHorizons(root);
    repetitions.gloves.push_back(ReadScenario(text, lists, i, root, of_this).glove);
  }
  CheckRepetitions(lists, repetitions, source);
  const YAML::Node seed_in_file =
      ChildOf(ParseYaml(text.file, text.text, YamlIncludes::kAllowed), "seed");
  repetitions.Rotate(scenario.seed - (seed_in_file.IsDefined() && seed_in_file.IsScalar()
                                          ? seed_in_file.as<int>(Scenario{}.seed)
                                          : Scenario{}.seed));
  return repetitions;
}

}  // namespace

Scenario ParseScenario(const ScenarioSource& text) {
  YAML::Node root;
  YamlSource source;
  const RepeatedSettings lists = FirstTreeOf(text, root, source);
  const std::vector<AutoHorizon> auto_horizons = TakeAutoHorizons(root);
  Scenario scenario = ReadScenario(text, lists, 0, root, source);
  CheckNames(root, source, scenario);
  FillControllers(root, source, auto_horizons, scenario);
  CheckBaseline(root, source, scenario);
  CheckVideoSize(root, source, scenario.video);
  scenario.repetitions = AllRepetitions(text, lists, source, scenario);
  scenario.glove = GloveOf(scenario, scenario.seed);
  return scenario;
}

std::string PlaceOfSetting(const ScenarioSource& text, const std::string& key) {
  YAML::Node root;
  YamlSource source;
  const RepeatedSettings lists = FirstTreeOf(text, root, source);
  const YAML::Node node = NodeAt(root, key);
  if (source.OverrideOf(key) == nullptr && node.is(root)) return text.file.string();
  return source.PlaceOf(node, key);
}

Scenario LoadScenario(const std::filesystem::path& file,
                      const std::vector<std::string>& overrides) {
  return ParseScenario({.file = file, .text = ReadYamlText(file), .overrides = overrides});
}

}  // namespace gauntlet::sim
