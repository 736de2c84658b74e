#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace gauntlet::sim {

/// Cutting of lines into cells, and writing of cells. The meaning of a cell is not known here.

/// Longest line in bytes, with its end. It is longer than any row of numbers, and bounds the memory
/// for files that are not text.
inline constexpr std::size_t kLongestLine = std::size_t{1} << 20;
/// The error message for a longer line.
std::string LineTooLong();

/// `text` without the byte order mark that spreadsheets write.
std::string_view WithoutByteOrderMark(std::string_view text);

/// `text` without blanks at both ends; the carriage return of CRLF counts as blank.
std::string_view Trimmed(std::string_view text);

/// Trimmed text without surrounding quotes, single or double.
std::string_view Unquoted(std::string_view text);

/// The number in a cell: infinite above the range of a double, 0 below it. NaN for a missing value:
/// an empty cell, `nan`, `NA`, `N/A`, `null` or `none` in upper or lower case. None for any other
/// text.
std::optional<double> NumberOrMissing(std::string_view cell);

/// Removes the first cell and its separator from `rest` and returns the cell. The separator ' '
/// stands for any number of blanks.
std::string_view TakeCell(std::string_view& rest, char separator);

/// All cells of a line: one more than there are separators. So an empty line has one empty cell.
std::vector<std::string_view> SplitCells(std::string_view line, char separator = ',');

/// The lines of a text, without line ends and byte order mark.
std::vector<std::string_view> SplitLines(std::string_view text);

/// A row of a CSV table with its line end. Cells with separators, quotes or line ends are quoted
/// (RFC 4180).
std::string CsvLine(const std::vector<std::string>& cells);

/// Shortest text that reads back as the same value; empty if the value is not finite.
std::string NumberOrNothing(double value);

}  // namespace gauntlet::sim
