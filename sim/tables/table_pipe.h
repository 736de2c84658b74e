#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "sim/tables/table.h"

namespace gauntlet::sim {

/// Numbers and texts as bytes, from a helper process to the program.
class PipeWriter {
 public:
  explicit PipeWriter(std::function<void(std::span<const char>)> send) : send_(std::move(send)) {}
  void Count(std::uint64_t count);
  void Number(double number) { Numbers({&number, 1}); }
  void Numbers(std::span<const double> numbers);
  void Text(std::string_view text);
  void Texts(const std::vector<std::string>& texts);

 private:
  std::function<void(std::span<const char>)> send_;
};

/// Reads what a PipeWriter wrote. Errors: UserError without a place for sizes that no writer sends.
class PipeReader {
 public:
  /// `fill` fills all bytes.
  explicit PipeReader(std::function<void(std::span<char>)> fill) : fill_(std::move(fill)) {}
  std::uint64_t Count(std::uint64_t most);
  double Number();
  void Numbers(std::span<double> numbers);
  std::string Text();
  std::vector<std::string> Texts();

 private:
  std::function<void(std::span<char>)> fill_;
};

/// Rows of a block of a table with so many columns.
std::size_t RowsOfBlock(std::size_t columns);

/// Writes a table of numbers row by row, in blocks.
class TableWriter {
 public:
  /// `rows`: number of rows, if it is known; else 0.
  TableWriter(PipeWriter& pipe, const std::vector<std::string>& names,
              const std::vector<std::string>& remarks, std::size_t rows);
  /// Whole rows, one behind the other. Shapes: a multiple of the names.
  void Rows(std::span<const double> values);
  /// `order`: the places of the rows in the order that the reader gives them; empty: as written.
  void Finish(bool is_cut = false, std::span<const double> order = {});

 private:
  void Flush();

  PipeWriter& pipe_;
  std::size_t columns_ = 0;
  std::vector<double> block_;
};

/// Reads what a TableWriter wrote, block by block.
class TableReader {
 public:
  /// Reads names and remarks. `pipe` must outlive it.
  explicit TableReader(PipeReader& pipe);
  /// A table without rows.
  const Table& head() const { return head_; }
  /// Number of rows, if the writer knew it; else 0.
  std::uint64_t known_rows() const { return known_rows_; }
  /// Appends the rows of the next block. False behind the last one: then the table knows whether it
  /// is cut.
  bool ReadBlock(Table& table);
  /// Behind the last block: the places of the rows in the order that they have; empty: as they are.
  std::vector<double> ReadOrder(const Table& table);

 private:
  PipeReader& pipe_;
  Table head_;
  std::uint64_t known_rows_ = 0;
  std::vector<double> block_;
};

/// The table that a TableWriter wrote.
Table ReadTable(PipeReader& pipe);

}  // namespace gauntlet::sim
