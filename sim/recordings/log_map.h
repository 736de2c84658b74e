#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "sim/recordings/column_scale.h"

namespace gauntlet::sim {

/// A column of a log of commands and angles: angle [deg] = scale * value + offset_deg.
struct PartMapping {
  std::size_t column = 0;
  std::string role;  // command, angle or motor
  std::string part;  // joint or motor; empty in a log of one
  double scale = 1.0;
  double offset_deg = 0.0;
};

/// Which column of a log is what.
struct LogMap {
  std::vector<TimeMapping> time;  // empty: not by the map
  std::vector<PartMapping> parts;
};

/// From a map file as ReadColumnMap() reads it, with the channels `command`, `angle` and `motor`,
/// and the name of the part in the key `joint`. Errors: UserError `map:row:column: ...`.
LogMap ReadLogMap(const std::filesystem::path& map, const RecordingColumns& recording);

}  // namespace gauntlet::sim
