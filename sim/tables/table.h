#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <utility>
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
  bool is_tracked = false;           // angles of a hand that a camera or suit followed
  std::vector<std::string> remarks;  // findings about the table
  std::size_t first_line = 2;        // of the rows, for messages
  std::string angle_unit = {};       // deg or rad; angle: either; empty: the format has none

  std::vector<std::string> names() const {
    std::vector<std::string> names;
    for (const TableColumn& column : columns) names.push_back(column.name);
    return names;
  }
};

/// A table of a file that may be larger than memory: its rows come once, a block at a time.
class TableStream {
 public:
  /// Appends the rows of the next block; false behind the last one.
  using NextBlock = std::function<bool(Table& table)>;
  /// `head`: a table without rows. `all_rows`: their number, if it is known; else 0.
  TableStream(Table head, std::uint64_t all_rows, NextBlock next)
      : table_(std::move(head)), all_rows_(all_rows), next_(std::move(next)) {}

  /// The facts of the table, and the rows that are here.
  const Table& table() const { return table_; }
  std::uint64_t all_rows() const { return all_rows_; }
  /// True if the first rows are not here any more.
  bool is_begun() const { return is_begun_; }
  /// Adds rows to those that are here. False at the end.
  bool Extend() { return !is_done_ && !(is_done_ = !next_(table_)); }
  /// Replaces the rows that are here by the next ones. False at the end: then there are none.
  bool Advance() {
    is_begun_ = true;
    for (TableColumn& column : table_.columns) column.numbers.clear();
    table_.rows = 0;
    return Extend();
  }

 private:
  Table table_;
  std::uint64_t all_rows_;
  NextBlock next_;
  bool is_begun_ = false;
  bool is_done_ = false;
};

/// A table for a reader: a text, or columns whose names and types are known.
using TableInput =
    std::variant<TextLines::Source, std::shared_ptr<const Table>, std::shared_ptr<TableStream>>;
/// The whole table, where columns are known; none of a text.
std::shared_ptr<const Table> WholeTable(const TableInput& input);

}  // namespace gauntlet::sim
