#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "sim/inspect/table_layout.h"
#include "sim/inspect/table_statistics.h"
#include "sim/recordings/array_table.h"
#include "sim/recordings/file_format.h"

namespace gauntlet::sim {

/// Of a larger file the beginning is read: hours of any glove.
inline constexpr std::uintmax_t kMostInspectedBytes = std::uintmax_t{1} << 30;

/// What the numbers of a glove's columns are.
enum class RawUnit { kCounts, kShare, kDegrees, kRadians, kVolts, kUnknown };
std::string_view NameOf(RawUnit unit);

/// A column, and what it is taken for.
struct InspectedColumn {
  std::string name;  // may be empty
  CellKind kind = CellKind::kNumber;
  ColumnStatistics statistics;  // of numbers
  std::string time_unit;        // as in a column map; empty: it has no part in the time
  std::string channel;          // empty: it is left out
  bool is_inverted = false;     // it falls where the joint bends
  std::string why;              // it is taken for this, or left out
};

/// What a stranger's recording is.
struct Inspection {
  std::string file;
  FileFormat format = FileFormat::kText;
  std::string array;                // as it was chosen
  std::vector<ListedArray> arrays;  // of a file that has any
  std::uintmax_t file_bytes = 0;
  bool is_whole = true;  // only the beginning of a large file is read
  TableLayout layout;
  std::size_t rows = 0;
  std::map<std::string, std::size_t> problems;  // in rows, by NameOf() them
  std::string time_why;                         // why these columns, or none, are the time
  bool has_time = false;
  bool rate_is_known = false;
  TimeStatistics time;  // rate_hz also without a time, as it was given or is assumed
  RawUnit unit = RawUnit::kUnknown;
  int bits = 0;  // of counts
  std::string unit_why;
  std::vector<InspectedColumn> columns;
  std::vector<double> picture_time_s;               // of some rows
  std::vector<std::vector<double>> picture_values;  // per column; empty for one without numbers

  std::vector<std::size_t> MappedColumns() const;
};

struct InspectionOptions {
  double rate_hz = 0.0;  // of a file without time, if the user knows it; 0: unknown
  std::string array;     // of a file with arrays, see ListArrays(); empty: by their sizes
  std::string preset;    // glove whose sensors the columns are, in its order; empty: by names
};

/// Errors: UserError in one line for a file without a table that can be read.
Inspection Inspect(const std::filesystem::path& file, const InspectionOptions& options);

}  // namespace gauntlet::sim
