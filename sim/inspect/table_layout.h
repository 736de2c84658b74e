#pragma once

#include <string>
#include <vector>

#include "sim/recordings/csv_reader.h"

namespace gauntlet::sim {

/// Place and shape of the table in a text. The shape is that of its CsvReader: a recording that is
/// played has the same one.
struct TableLayout {
  char separator = ',';
  bool decimal_comma = false;
  int skipped_lines = 0;    // before the line with which the reader begins
  bool has_header = false;  // that line has the names
  std::size_t columns = 0;
  std::vector<std::string> names;              // of columns, also from a line that is skipped
  std::vector<std::string> notes;              // lines before the table
  std::vector<std::vector<std::string>> rows;  // the first ones, as text
};

struct FoundTable {
  TableLayout layout;
  CsvReader reader;  // before the first row; it repairs
};

/// Where the table begins is found from the first 256 KB.
/// Errors: UserError if there is no table, or one with a row per channel.
FoundTable FindTable(const std::string& name, CsvReader::Source source,
                     CsvReader::Listener listener = {});

/// What nearly all cells of a column are.
enum class CellKind { kNumber, kTime, kText };
CellKind KindOf(const TableLayout& layout, std::size_t column);
/// The number in a cell of the layout's rows; NaN if there is none.
double NumberIn(const TableLayout& layout, const std::string& cell);

}  // namespace gauntlet::sim
