#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "sim/recordings/column_map.h"
#include "sim/recordings/csv_reader.h"

namespace gauntlet::sim {

/// A column of a channel's counts or angle; `scale` brings the angle to degrees.
struct ChannelColumn {
  std::size_t column = 0;
  std::string channel;
  double scale = 1.0;
};

/// Which column of a recording of known poses is what: see LoadPoseRecording.
struct PoseColumns {
  std::vector<TimeMapping> time;  // its sum; empty: the file has none
  std::vector<ChannelColumn> counts;
  std::vector<ChannelColumn> angles;  // in the order of `counts`; empty: none is known
  double full_scale_counts = 0.0;     // by the map's bits; 0: it has none
  std::size_t left_out = 0;           // other signals of a trace
  std::vector<std::string> unknown;   // names of other columns that are left out
};

/// By their names, or by a column map.
/// Errors: UserError `file:row:column: ...`.
PoseColumns FindPoseColumns(const CsvReader& csv, const std::string& map);

}  // namespace gauntlet::sim
