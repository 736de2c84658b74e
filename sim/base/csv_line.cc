#include "sim/base/csv_line.h"

#include <algorithm>

namespace gauntlet::sim {
namespace {

constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";

bool IsBlank(char c) { return c == ' ' || c == '\t' || c == '\r'; }

}  // namespace

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

std::string_view TakeCell(std::string_view& rest, char separator) {
  if (separator == ' ') {
    rest = Trimmed(rest);
    const std::string_view cell = rest.substr(0, rest.find_first_of(" \t"));
    rest = Trimmed(rest.substr(cell.size()));
    return cell;
  }
  const std::string_view cell = rest.substr(0, rest.find(separator));
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
    std::string_view line = TakeCell(text, '\n');
    if (line.ends_with('\r')) line.remove_suffix(1);
    lines.push_back(line);
  }
  return lines;
}

}  // namespace gauntlet::sim
