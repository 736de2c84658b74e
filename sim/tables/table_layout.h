#pragma once

#include <string>
#include <vector>

#include "sim/tables/csv_reader.h"

namespace gauntlet::sim {

/// Position and shape of the table in a text. The shape is that of its CsvReader, and the same when
/// the recording is played.
struct TableLayout {
  char separator = ',';
  bool decimal_comma = false;
  int skipped_lines = 0;    // lines before the reader's first line
  bool has_header = false;  // the reader's first line contains the names
  std::size_t columns = 0;
  std::vector<std::string> names;     // of columns, also from skipped lines
  std::size_t rows_before = 0;        // rows of other tables, with another number of columns
  std::size_t second_names_line = 0;  // in the table, with names in another order; 0: none
  std::string extra_name = {};        // the last of one name more than columns; empty: as many
  std::vector<std::string> notes;     // lines before the table
  std::vector<std::vector<std::string>> rows;  // the first rows as text
};

struct FoundTable {
  TableLayout layout;
  CsvReader reader;  // before the first row
};

/// Finds the table in the first 256 KB of a text; a Table has its layout.
/// Errors: UserError if there is no table, or if it has a row per channel.
FoundTable FindTable(const std::string& name, TableInput input, ProblemHandling handling,
                     CsvReader::Listener listener = {});

/// Kind of nearly all cells of a column.
enum class CellKind { kNumber, kTime, kText };
CellKind KindOf(const TableLayout& layout, std::size_t column);
/// Number in a cell of the layout's rows; NaN for other text.
double NumberIn(const TableLayout& layout, const std::string& cell);

}  // namespace gauntlet::sim
