#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <variant>
#include <vector>

#include "sim/tables/text_lines.h"

namespace gauntlet::sim {

/// A column of numbers or of texts.
struct TableColumn {
  std::string name;
  std::vector<double> numbers = {};     // NaN: missing
  std::vector<std::string> texts = {};  // instead of numbers
};

/// Every format but text becomes this. All columns have as many cells as there are rows.
struct Table {
  std::vector<TableColumn> columns;
  std::size_t rows = 0;
  bool is_cut = false;               // the file ends before its end; whole rows are here
  std::vector<std::string> remarks;  // findings about the table
  std::size_t first_line = 2;        // of the rows, for messages
  std::string angle_unit = {};       // deg or rad; angle: either; empty: the format has none

  std::vector<std::string> names() const {
    std::vector<std::string> names;
    for (const TableColumn& column : columns) names.push_back(column.name);
    return names;
  }
};

/// A table for a reader: a text, or columns whose names and types are known.
using TableInput = std::variant<TextLines::Source, std::shared_ptr<const Table>>;

}  // namespace gauntlet::sim
