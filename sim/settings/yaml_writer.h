#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "controller/settings.h"

namespace gauntlet::sim {

/// Every setting that `visit` shows, with its value, as YAML text that YamlReader reads back to the
/// same values: numbers have the digits that identify them. Paths are written as a file in `folder`
/// names them, so that both can be moved together: relative to it, or by the name of what Gauntlet
/// brings along. Without a folder, as they are.
std::string SettingsToYaml(const std::function<void(controller::SettingsVisitor&)>& visit,
                           const std::filesystem::path& folder = {});

/// YAML for people: with the help of each section and group as a comment, and a line for each row
/// of a table.
std::string SettingsToYamlForPeople(const std::function<void(controller::SettingsVisitor&)>& visit);

}  // namespace gauntlet::sim
