#pragma once

#include <string>

#include "sim/settings/yaml_tree.h"

namespace gauntlet::sim {

/// Puts one --set over the tree of a scenario, as ApplyOverride() does, and besides:
///
/// - `key.path+=number` adds to the value of the file, or to the default;
/// - `controllers+=KIND` and `controllers+=KIND:key=value,...` add a controller with this filter,
///   called by its kind, with a number if there is one of that name.
///
/// Errors: UserError, which for a key of another level names the whole paths that end in it.
void ApplySet(YamlNode& root, const std::string& text, YamlSource& source);

}  // namespace gauntlet::sim
