#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "sim/recordings/csv_reader.h"

namespace gauntlet::sim {

/// How the numbers of a recording's columns become joint angles.
enum class RecordedUnit {
  kDegrees,
  kRadians,
  kCounts,  // of the nominal sensor and the scenario's converter
  kShare,   // of the joint's range: 0 its lower end, 1 its upper end
};

/// One column: angle = unit(sign * scale * value + offset).
struct ColumnMapping {
  std::size_t column = 0;  // from 0
  int channel = 0;
  RecordedUnit unit = RecordedUnit::kDegrees;
  double scale = 1.0;   // sign included
  double offset = 0.0;  // in the unit
};

/// Which column is what.
struct ColumnMap {
  std::optional<std::size_t> time_column;
  double time_scale_s = 1.0;  // seconds per unit of the time column
  std::vector<ColumnMapping> channels;
};

/// From the names in the file's header: a column of time (see TimeScaleS) or the name of a channel
/// with the unit as a suffix (`index_mcp_rad`), without one degrees. `k`, the sample's number in a
/// trace, is passed over. In a strict reading every column must be known; otherwise the unknown
/// ones are reported and left out.
/// Errors: UserError at the place in the recording.
ColumnMap MapByHeader(const CsvReader& recording, ProblemHandling handling,
                      std::vector<std::string>& left_out);

/// From a map file: a text table like a recording (see CsvReader), with a header `column,channel`
/// and any of `unit`, `scale`, `sign`, `offset`. `column` is a name in the recording's header or a
/// number from 1; `channel` is a channel or `time`; `unit` is deg, rad, counts or share, for time
/// s, ms or us. Columns that the map does not name are left out. Errors: UserError `map:row:column:
/// ...`.
ColumnMap ReadColumnMap(const std::filesystem::path& map, const CsvReader& recording);

}  // namespace gauntlet::sim
