#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "sim/fit/pose_recording.h"
#include "sim/recordings/column_map.h"
#include "sim/tables/table_layout.h"

namespace gauntlet::sim {

/// A column with a channel's counts or angle; `scale` converts the angle to degrees. `bits` of the
/// counts' converter are those of the map; 0: not given.
struct ChannelColumn {
  std::size_t column = 0;
  std::string channel;
  double scale = 1.0;
  int bits = 0;
};

/// Meaning of the columns of a recording of known poses: see LoadPoseRecording.
struct PoseColumns {
  std::vector<TimeMapping> time;  // summed; empty: no time column
  std::vector<ChannelColumn> counts;
  std::vector<ChannelColumn> angles;  // in the order of `counts`; empty: no known angles
  std::vector<std::string> unknown;   // names of other ignored columns
  std::optional<HandRows> hand;       // none: all rows
};

/// Finds the columns by their names, or by a column map, as of `format`.
/// Errors: UserError `file:row:column: ...`.
PoseColumns FindPoseColumns(const FoundTable& table, const PoseRecordingFormat& format);

}  // namespace gauntlet::sim
