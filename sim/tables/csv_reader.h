#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "sim/tables/recording_problem.h"
#include "sim/tables/table.h"
#include "sim/tables/text_lines.h"

namespace gauntlet::sim {

/// Handling of a value or row that is not as it should be.
enum class ProblemHandling {
  kStrict,        // stops with a UserError at the first one
  kRepair,        // gives NaN for what is no value and reports; see LoadRecording for glitches
  kRemove,        // the same, and no glitch reaches a controller
  kAllowMissing,  // strict, but a missing value is NaN and no problem
};
/// As settings name the first three.
inline constexpr std::array<std::string_view, 3> kProblemHandlingNames = {"strict", "repair",
                                                                          "remove"};
/// True if a bad value is reported and does not stop the reader.
constexpr bool GoesOn(ProblemHandling handling) {
  return handling == ProblemHandling::kRepair || handling == ProblemHandling::kRemove;
}

/// Reads numbers from a Table, or from text with one row a line (see TextLines), in one pass. It
/// owns the shape of the table: its separator, columns, header and rows are those that it finds,
/// for all who use it.
///
/// A text has comma, semicolon, tab or spaces between cells (found from the first line), blank
/// lines, lines that start with '#', quoted names, and a decimal comma if the separator is another
/// character. A first line with a cell that is no value (see IsValue) is the header. An empty cell,
/// `nan` or `NA` is a missing value (see NumberOrMissing). A header one name short lacks the first
/// column's name, or the last one's if it starts with the time. Errors: UserError `file:row:column:
/// ...`; row is the line of the file, column the cell, from 1.
class CsvReader {
 public:
  using Source = TextLines::Source;
  /// Hears of every problem that was repaired.
  using Listener = std::function<void(RecordingProblem problem, std::size_t row)>;

  /// `name` stands for the file in messages; `skipped_lines` at the beginning of a text are no part
  /// of the table.
  CsvReader(std::string name, TableInput input, ProblemHandling handling, Listener listener = {},
            int skipped_lines = 0);

  /// Empty if the file has none. A nameless column has an empty name.
  const std::vector<std::string>& header() const { return header_; }
  std::size_t column_count() const { return column_count_; }
  char separator() const { return separator_; }

  /// Do not read this column (from 0): its values are NaN and may be text.
  void Ignore(std::size_t column) { meanings_.at(column) = Meaning::kIgnored; }
  /// The numbers of this column are the seconds of dates and clocks: see SecondsOfText.
  void ReadAsTime(std::size_t column) { meanings_.at(column) = Meaning::kTime; }

  /// The numbers of this column are those of its texts, in the order of their first rows.
  void ReadAsTexts(std::size_t column) { meanings_.at(column) = Meaning::kText; }

  /// NextRow() passes over rows whose text in this column is not kept; its numbers are 1.
  void KeepRows(std::size_t column, std::function<bool(std::string_view text)> is_kept);

  /// The first rows that have column_count() cells, as text: at most so many of those up to a line
  /// of the text, and of so many bytes of a Table. NextRow() gives them again.
  std::vector<std::vector<std::string>> FirstRows(std::size_t most, std::size_t last_line,
                                                  std::size_t most_bytes = SIZE_MAX);
  /// The next row; false at the end. `values` has column_count() places.
  bool NextRow(std::span<double> values);
  /// Next row as text, without quotes; false at the end.
  bool NextRow(std::vector<std::string>& cells);
  /// The number in a cell of the row that was given last; column from 1.
  double Number(std::string_view cell, std::size_t column);
  /// Line of the row that NextRow() gave last, from 1.
  std::size_t row() const { return row_; }
  /// Share of a Table's rows that were read; NaN for a text, whose length is not known.
  double share_read() const;
  /// Line of the first row of data.
  std::size_t first_row() const { return first_row_line_; }
  const std::string& name() const { return name_; }
  /// Remarks of the Table; one of them if it is cut.
  std::vector<std::string> remarks() const;
  /// Unit of the angles in the Table.
  std::string angle_unit() const { return table_ ? table_->angle_unit : ""; }

  /// A cell or the name of a column as it may stand in a message: short, printable, in quotes.
  /// '...' stands for what may be of no table at all: for letters in a file of one column, and for
  /// what has letters and does not look like a key.
  std::string Quoted(std::string_view cell) const;

  /// A UserError at a place of this file: in the row that NextRow() gave last, or in `row`.
  [[noreturn]] void Fail(std::size_t column, const std::string& problem) const;
  [[noreturn]] void FailInRow(std::size_t row, std::size_t column,
                              const std::string& problem) const;

 private:
  void UseTable(const Table& table);
  bool NextRowOfTable();
  double TableNumber(std::size_t column);
  std::string TableCell(std::size_t column) const;
  bool NextLine(std::string_view& line);
  void ReadFirstLine();
  void ReadFirstRowOfData();
  std::vector<std::string> CellsOf(std::string_view line) const;
  void ParseRow(std::string_view line, std::span<double> values);
  double TextNumber(std::string_view cell);
  double ValueOf(std::string_view cell, std::size_t column);  // by its meaning
  bool ReadRow(std::span<double> values);
  void Problem(RecordingProblem problem, std::size_t column, const std::string& message);

  std::string name_;
  std::shared_ptr<const Table> table_;   // none: text
  std::shared_ptr<TableStream> stream_;  // that the table is a part of; none: it is whole
  std::size_t rows_read_ = 0;            // of the table
  std::size_t rows_before_ = 0;          // of the stream, which are not in the table any more
  TextLines lines_;
  ProblemHandling handling_;
  Listener listener_;
  std::vector<std::string> header_;
  std::size_t column_count_ = 0;
  char separator_ = ',';
  enum class Meaning : char { kNumber, kTime, kText, kKept, kIgnored };
  std::vector<Meaning> meanings_;                            // of columns
  std::map<std::string, double, std::less<>> text_numbers_;  // of columns read as texts
  std::size_t kept_column_ = 0;
  std::function<bool(std::string_view)> is_kept_ = {};  // none: all rows
  std::size_t first_row_line_ = 0;
  std::size_t row_ = 0;
};

/// The table of all rows of a text. A column has texts if one of its cells is no number.
Table TableOfText(CsvReader reader);
/// TableOfText() where the header of the text gives the number of rows. Another number is a remark.
/// Without rows, the last line without an end is cut: it is left out.
Table TableOfText(CsvReader reader, std::optional<std::int64_t> rows, bool has_last_line_end);

/// A source that reads a file. Throws UserError if it cannot be opened.
CsvReader::Source FileSource(const std::filesystem::path& path);
/// A source that reads text in memory, which must outlive it.
CsvReader::Source TextSource(std::string_view text);

/// Text in UTF-16 with its byte order mark, as spreadsheets write "Unicode text", in UTF-8. What is
/// no character becomes U+FFFD.
CsvReader::Source Utf8Of(CsvReader::Source utf16);

}  // namespace gauntlet::sim
