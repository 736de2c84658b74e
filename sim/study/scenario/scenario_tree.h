#pragma once

#include <string>

#include "sim/settings/yaml_tree.h"

namespace gauntlet::sim {

/// Puts the settings of files in the place of `controllers: {NAME: !include FILE}`, before --set
/// goes over them. A file is relative to the one that includes it, has what stands below the name
/// of a controller, and includes no others. `source` learns which settings are from which file.
/// Errors: UserError for a file that cannot be read, and for !include anywhere else.
void IncludeControllers(YamlNode& root, YamlSource& source);

/// Leaves out settings of earlier versions that had no effect, as files of finished runs list them
/// all. Errors: UserError for one that had an effect, with what to use instead.
void LeaveOutRemovedSettings(const YamlSource& source, YamlNode& root);

/// Puts one --set over the tree of a scenario, as ApplyOverride() does, and besides:
///
/// - `key.path+=number` adds to the value of the file, or to the default;
/// - `controllers+=KIND` and `controllers+=KIND:key=value,...` add a controller with this filter,
///   called by its kind, with a number if there is one of that name.
///
/// Errors: UserError, which for a key of another level names the whole paths that end in it.
void ApplySet(YamlNode& root, const std::string& text, YamlSource& source);

}  // namespace gauntlet::sim
