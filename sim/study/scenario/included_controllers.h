#pragma once

#include "sim/settings/yaml_tree.h"

namespace gauntlet::sim {

/// Puts the settings of files in the place of `controllers: {NAME: !include FILE}`, before --set
/// goes over them. A file is relative to the one that includes it, has what stands below the name
/// of a controller, and includes no others. `source` learns which settings are from which file.
/// Errors: UserError for a file that cannot be read, and for !include anywhere else.
void IncludeControllers(YamlNode& root, YamlSource& source);

}  // namespace gauntlet::sim
