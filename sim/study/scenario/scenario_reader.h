#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "sim/settings/yaml_tree.h"
#include "sim/study/scenario/scenario.h"

namespace gauntlet::sim {

/// A scenario file as it was read, and what --set puts over it: `key.path=value`, in order.
struct ScenarioSource {
  std::filesystem::path file;
  std::string text;
  std::vector<std::string> overrides = {};
};

/// A scenario's text as a tree, with the settings of files that it includes. For any number of
/// threads.
struct ScenarioText {
  YamlNode root;
  YamlSource source;
};

/// Errors: UserError with file:line:column.
ScenarioText ParseScenarioText(const std::filesystem::path& file, std::string_view text);

/// Reads strictly: unknown, duplicate, missing or non-finite is a UserError with file:line:column,
/// and so is what could not be a name or a text of the results. Paths in the scenario are relative
/// to the file.
///
/// Repetitions begin, if --set changes the seed, with the one that the new seed has in the file: a
/// seed is the same trial however it is asked for.
Scenario ParseScenario(const ScenarioText& text, const std::vector<std::string>& overrides);
/// As above, for text and overrides in one source.
Scenario ParseScenario(const ScenarioSource& source);

/// Place of a setting: `file:line:column` or `--set text`; the file if it has a default value.
std::string PlaceOfSetting(const ScenarioSource& source, const std::string& key);

/// ParseScenario() of what the file holds. Errors: UserError also for one that cannot be read.
Scenario LoadScenario(const std::filesystem::path& file, const std::vector<std::string>& overrides);

}  // namespace gauntlet::sim
