#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "sim/recordings/recording_problem.h"

namespace gauntlet::sim {

/// What a reader does with a value or row that is not as it should be.
enum class ProblemHandling {
  kStrict,        // stops with a UserError at the first one
  kRepair,        // gives NaN for the value and reports
  kAllowMissing,  // strict, but a missing value is NaN and no problem
};
/// As settings name the first two.
inline constexpr std::array<std::string_view, 2> kProblemHandlingNames = {"strict", "repair"};

/// Reads numbers from text with one row a line, in one pass and with a fixed buffer, so that memory
/// does not grow with the file.
///
/// Takes comma, semicolon, tab or spaces between cells (found from the first line), LF or CRLF, a
/// byte order mark, blank lines, lines that start with '#', quoted names, and a decimal comma if
/// the separator is another character. A first line with a cell that is neither a number nor a time
/// (see SecondsOfText) is the header.
/// An empty cell, `nan` or `NA` is a missing value (see NumberOrMissing). A header one name short
/// lacks the first column's name, or the last one's if it starts with the time. Errors: UserError
/// `file:row:column: ...`; row is the line of the file, column the cell, from 1.
class CsvReader {
 public:
  /// Fills a buffer and says how many bytes it gave; 0 is the end.
  using Source = std::function<std::size_t(char* buffer, std::size_t size)>;
  /// Hears of every problem that was repaired.
  using Listener = std::function<void(RecordingProblem problem, std::size_t row)>;

  /// `name` stands for the file in messages; `skipped_lines` at its beginning are no part of the
  /// table.
  CsvReader(std::string name, Source source, ProblemHandling handling, Listener listener = {},
            int skipped_lines = 0);

  /// Empty if the file has none. A nameless column has an empty name.
  const std::vector<std::string>& header() const { return header_; }
  std::size_t column_count() const { return column_count_; }

  /// Do not read this column (from 0): its values are NaN and may be text.
  void Ignore(std::size_t column) { meanings_[column] = Meaning::kIgnored; }
  /// The numbers of this column are the seconds of dates and clocks: see SecondsOfText.
  void ReadAsTime(std::size_t column) { meanings_[column] = Meaning::kTime; }

  /// The next row; false at the end. `values` has column_count() places.
  bool NextRow(std::span<double> values);
  /// The same as text, without quotes.
  bool NextRow(std::vector<std::string>& cells);
  /// The number in a cell of the row that was given last; column from 1.
  double Number(std::string_view cell, std::size_t column);
  /// Line of the row that NextRow() gave last, from 1.
  std::size_t row() const { return row_; }
  /// Line of the first row of data.
  std::size_t first_row() const { return first_row_line_; }
  const std::string& name() const { return name_; }

  /// A cell or the name of a column as it may stand in a message: short, printable, in quotes.
  /// '...' stands for what may be of no table at all: for letters in a file of one column, and for
  /// what has letters and does not look like a key.
  std::string Quoted(std::string_view cell) const;

  /// A UserError at a place of this file: in the row that NextRow() gave last, or in `row`.
  [[noreturn]] void Fail(std::size_t column, const std::string& problem) const;
  [[noreturn]] void FailInRow(std::size_t row, std::size_t column,
                              const std::string& problem) const;

 private:
  bool NextLine(std::string_view& line);
  bool NextUsefulLine(std::string_view& line);
  void Refill();
  void ReadFirstLine(int skipped_lines);
  void ReadFirstRowOfData();
  bool NextLineOfData(std::string_view& line);
  void ParseRow(std::string_view line, std::span<double> values);
  void Problem(RecordingProblem problem, std::size_t column, const std::string& message);

  std::string name_;
  Source source_;
  ProblemHandling handling_;
  Listener listener_;
  std::vector<std::string> header_;
  std::size_t column_count_ = 0;
  char separator_ = ',';
  enum class Meaning : char { kNumber, kTime, kIgnored };
  std::vector<Meaning> meanings_;  // of columns
  bool has_first_row_ = false;
  std::string first_row_;
  std::size_t first_row_line_ = 0;
  std::size_t row_ = 0;

  std::vector<char> buffer_;
  std::size_t begin_ = 0;
  std::size_t end_ = 0;
  bool source_is_empty_ = false;
};

/// What stands between the cells of a line: semicolon, tab, comma or blanks, in this order; blanks
/// before commas where these can only be decimal ones, as in `0,01 1,5`. Not what stands in quotes.
char SeparatorOf(std::string_view text);

/// A source that reads a file. Throws UserError if it cannot be opened.
CsvReader::Source FileSource(const std::filesystem::path& path);
/// A source that reads text in memory, which must outlive it.
CsvReader::Source TextSource(std::string_view text);

}  // namespace gauntlet::sim
