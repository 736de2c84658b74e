#include "sim/base/csv_line.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <string>

#include "controller/number.h"

namespace gauntlet::sim {
namespace {

constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";

/// Texts for a missing value, in lower case.
constexpr std::array<std::string_view, 6> kMissing = {"", "nan", "na", "n/a", "null", "none"};

bool IsMissing(std::string_view cell) {
  return std::ranges::any_of(kMissing, [cell](std::string_view missing) {
    return std::ranges::equal(cell, missing, {}, [](unsigned char c) { return std::tolower(c); });
  });
}

bool IsBlank(char c) { return c == ' ' || c == '\t' || c == '\r'; }

/// End of the first cell: the separator or the end of the text. A cell in double quotes may contain
/// separators, and quotes written twice (RFC 4180). A quote that is never closed is an ordinary
/// character.
std::size_t CellEnd(std::string_view text, char separator) {
  const std::size_t begin = text.find_first_not_of(" \t");
  if (begin == std::string_view::npos || text[begin] != '"' || separator == '"') {
    return text.find(separator);
  }
  for (std::size_t quote = text.find('"', begin + 1); quote != std::string_view::npos;
       quote = text.find('"', quote + 1)) {
    if (text.substr(quote + 1).starts_with('"')) {
      ++quote;
      continue;
    }
    const std::size_t next = text.find_first_not_of(" \t\r", quote + 1);
    if (next == std::string_view::npos || text[next] == separator) return next;
    break;
  }
  return text.find(separator);
}

}  // namespace

std::string LineTooLong() { return fmt::format("the line is longer than {} bytes", kLongestLine); }

std::string_view WithoutByteOrderMark(std::string_view text) {
  if (text.starts_with(kByteOrderMark)) text.remove_prefix(kByteOrderMark.size());
  return text;
}

std::string_view Trimmed(std::string_view text) {
  while (!text.empty() && IsBlank(text.front())) text.remove_prefix(1);
  while (!text.empty() && IsBlank(text.back())) text.remove_suffix(1);
  return text;
}

std::string_view Unquoted(std::string_view text) {
  text = Trimmed(text);
  if (text.size() >= 2 && text.front() == text.back() && (text[0] == '"' || text[0] == '\'')) {
    text = text.substr(1, text.size() - 2);
  }
  return text;
}

std::optional<double> NumberOrMissing(std::string_view cell) {
  cell = Unquoted(cell);
  if (IsMissing(cell)) return controller::kNaN;
  return controller::ParseNumberOfProgram(cell);
}

std::string_view TakeCell(std::string_view& rest, char separator) {
  if (separator == ' ') {
    rest = Trimmed(rest);
    const std::string_view cell = rest.substr(0, rest.find_first_of(" \t"));
    rest = Trimmed(rest.substr(cell.size()));
    return cell;
  }
  const std::string_view cell = rest.substr(0, CellEnd(rest, separator));
  rest.remove_prefix(std::min(cell.size() + 1, rest.size()));
  return cell;
}

std::vector<std::string_view> SplitCells(std::string_view line, char separator) {
  const bool ends_with_separator = separator != ' ' && line.ends_with(separator);
  std::vector<std::string_view> cells;
  do {
    cells.push_back(TakeCell(line, separator));
  } while (!line.empty());
  if (ends_with_separator) cells.emplace_back();
  return cells;
}

std::vector<std::string_view> SplitLines(std::string_view text) {
  text = WithoutByteOrderMark(text);
  std::vector<std::string_view> lines;
  while (!text.empty()) {
    std::string_view line = text.substr(0, text.find('\n'));
    text.remove_prefix(std::min(line.size() + 1, text.size()));
    if (line.ends_with('\r')) line.remove_suffix(1);
    lines.push_back(line);
  }
  return lines;
}

std::string CsvLine(const std::vector<std::string>& fields) {
  std::string line;
  for (std::size_t i = 0; i < fields.size(); ++i) {
    if (i > 0) line += ',';
    if (fields[i].find_first_of(",\"\n\r") == std::string::npos) {
      line += fields[i];
      continue;
    }
    line += '"';
    for (const char c : fields[i]) line += c == '"' ? "\"\"" : std::string(1, c);
    line += '"';
  }
  return line + "\n";
}

std::string NumberOrNothing(double value) {
  return std::isfinite(value) ? fmt::format("{}", value) : "";
}

}  // namespace gauntlet::sim
