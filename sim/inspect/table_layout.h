#pragma once

#include <string>
#include <vector>

#include "sim/recordings/csv_reader.h"

namespace gauntlet::sim {

/// Where in a text the table is, found from its first 256 KB.
struct TableLayout {
  char separator = ',';
  bool decimal_comma = false;
  int skipped_lines = 0;    // before the line with which a CsvReader has to begin
  bool has_header = false;  // which that line is
  std::size_t columns = 0;
  std::vector<std::string> names;              // of columns, also from a line that is skipped
  std::vector<std::string> notes;              // lines before the table
  std::vector<std::vector<std::string>> rows;  // the first ones, as text
};

/// Errors: UserError if there is no table, or one with a row per channel.
TableLayout FindTable(const std::string& name, const CsvReader::Source& source);

/// What nearly all cells of a column are.
enum class CellKind { kNumber, kTime, kText };
CellKind KindOf(const TableLayout& layout, std::size_t column);
/// The number in a cell of the layout's rows; NaN if there is none.
double NumberIn(const TableLayout& layout, const std::string& cell);

}  // namespace gauntlet::sim
