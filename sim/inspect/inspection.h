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

/// Largest part of a file that is read: hours of any glove.
inline constexpr std::uintmax_t kMostInspectedBytes = std::uintmax_t{1} << 30;

/// Unit of the values in a glove's columns.
enum class RawUnit { kCounts, kShare, kDegrees, kRadians, kVolts, kUnknown };
std::string_view NameOf(RawUnit unit);

/// A column and its interpretation.
struct InspectedColumn {
  std::string name;  // may be empty
  CellKind kind = CellKind::kNumber;
  ColumnStatistics statistics;  // for numbers
  std::string time_unit;        // as in a column map; empty: not a time
  std::string channel;          // empty: ignored
  bool is_inverted = false;     // falls while the joint bends
  std::string why;              // reason for the channel, or for ignoring the column
};

/// Findings about a third-party recording.
struct Inspection {
  std::string file;
  FileFormat format = FileFormat::kText;
  std::string array;                // name of the chosen array
  std::vector<ListedArray> arrays;  // of a file with arrays
  std::uintmax_t file_bytes = 0;
  bool is_whole = true;  // false: only the beginning of a large file was read
  TableLayout layout;
  std::size_t rows = 0;
  std::map<std::string, std::size_t> problems;  // number of rows by problem, see NameOf()
  std::string time_why;                         // reason for these time columns, or for none
  bool has_time = false;
  bool rate_is_known = false;
  TimeStatistics time;  // without time columns: rate_hz as given or assumed
  RawUnit unit = RawUnit::kUnknown;
  int bits = 0;  // for counts
  std::string unit_why;
  std::vector<InspectedColumn> columns;
  std::vector<double> picture_time_s;               // of some rows
  std::vector<std::vector<double>> picture_values;  // per column; empty without numbers

  std::vector<std::size_t> MappedColumns() const;
};

struct InspectionOptions {
  double rate_hz = 0.0;  // of a file without time, if known; 0: unknown
  std::string array;     // of a file with arrays, see ListArrays(); empty: by size
  std::string preset;    // glove with these sensors in its order; empty: by names
};

/// Errors: UserError in one line if the file has no readable table.
Inspection Inspect(const std::filesystem::path& file, const InspectionOptions& options);

}  // namespace gauntlet::sim
