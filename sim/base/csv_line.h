#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace gauntlet::sim {

/// How text with one row a line is cut into cells and written. What cells mean is their reader's
/// matter.

/// Bytes of a line with its end: longer than any row of numbers; keeps memory flat on what is not
/// text.
inline constexpr std::size_t kLongestLine = std::size_t{1} << 20;
/// The sentence for a longer one.
std::string LineTooLong();

/// Without the mark that spreadsheets write at the beginning of a file.
std::string_view WithoutByteOrderMark(std::string_view text);

/// Without blanks at both ends, the carriage return of a line that ends with CRLF included.
std::string_view Trimmed(std::string_view text);

/// Trimmed, then without the quotes around it, single or double.
std::string_view Unquoted(std::string_view text);

/// The number in a cell, infinite beyond the range of a double and 0 below it; NaN where the value
/// is missing: an empty cell, `nan`, `NA`, `N/A`, `null` or `none` in any case of the letters.
/// Nothing for any other text.
std::optional<double> NumberOrMissing(std::string_view cell);

/// Takes the first cell off `rest`, which then begins behind the separator. The separator ' '
/// stands for any number of blanks.
std::string_view TakeCell(std::string_view& rest, char separator);

/// All cells of a line: one more than separators, so that an empty line has one empty cell.
std::vector<std::string_view> SplitCells(std::string_view line, char separator = ',');

/// The lines of a text, without their ends and the byte order mark.
std::vector<std::string_view> SplitLines(std::string_view text);

/// A row of a CSV table with its end; what would be read as its structure stands in quotes (RFC
/// 4180).
std::string CsvLine(const std::vector<std::string>& cells);

/// As text that reads back to the same; empty for what is not finite.
std::string NumberOrNothing(double value);

}  // namespace gauntlet::sim
