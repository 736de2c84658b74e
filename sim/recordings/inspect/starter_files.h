#pragma once

#include <string>

#include "sim/recordings/inspect/inspection.h"

namespace gauntlet::sim {

/// A column map for the recording, with the reason for each row as a comment. Sensors whose joint
/// is unknown are rows to fill in, with the channel `ignore`.
std::string StarterMap(const Inspection& inspection);

/// Text in double quotes for YAML.
std::string YamlText(const std::string& text);

/// A scenario that plays the recording through several filters. `map` and `recording` are their
/// paths in the scenario.
std::string StarterScenario(const Inspection& inspection, const std::string& recording,
                            const std::string& map);

/// Guesses in the angle of a column, as words of the map: "joint unit".
std::string AssumedOf(const Inspection& inspection, const InspectedColumn& column);

}  // namespace gauntlet::sim
