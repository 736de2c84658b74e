#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "sim/recordings/column_map.h"

namespace gauntlet::sim {

/// What a mapping adds to the angle of its channel: factor * value + offset_rad, its weight
/// included.
struct AngleScale {
  double factor = 1.0;  // rad per unit of the column
  double offset_rad = 0.0;
};

/// `low_counts` and `high_counts`: at the ends of a joint's range, of counts whose bits the map
/// does not say.
AngleScale ScaleOf(const ColumnMapping& mapping, double low_counts, double high_counts);

/// The columns of a table, as a map names them.
struct RecordingColumns {
  std::string name;                 // of the file, for messages
  std::vector<std::string> header;  // empty if the file has none
  std::size_t count = 0;
};

/// The same as for a CsvReader.
ColumnMap ReadColumnMap(const std::filesystem::path& map, const RecordingColumns& recording);

}  // namespace gauntlet::sim
