#pragma once

#include "sim/settings/yaml_tree.h"

namespace gauntlet::sim {

/// Leaves out settings of earlier versions that had no effect, as files of finished runs list them
/// all. Errors: UserError for one that had an effect, with what to use instead.
void LeaveOutRemovedSettings(const YamlSource& source, YamlNode& root);

}  // namespace gauntlet::sim
