#pragma once

#include <functional>
#include <string>

#include "controller/settings.h"

namespace gauntlet::sim {

/// Every setting that `visit` shows, with its value, as YAML text that YamlReader reads back to the
/// same values: numbers have the digits that identify them.
std::string SettingsToYaml(const std::function<void(controller::SettingsVisitor&)>& visit);

}  // namespace gauntlet::sim
