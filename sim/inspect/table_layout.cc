#include "sim/inspect/table_layout.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <string_view>
#include <utility>

#include "controller/calibration/robust_statistics.h"
#include "controller/number.h"
#include "sim/base/csv_line.h"
#include "sim/base/error.h"
#include "sim/recordings/time_columns.h"
#include "sim/recordings/time_text.h"

namespace gauntlet::sim {
namespace {

constexpr std::size_t kChunkBytes = 1 << 14;
constexpr std::size_t kHeadBytes = std::size_t{256} << 10;
constexpr std::size_t kMostRows = 2000;

std::string HeadOf(const CsvReader::Source& source) {
  std::string head;
  std::size_t got = 1;
  while (got > 0 && head.size() < kHeadBytes) {
    const std::size_t size = head.size();
    head.resize(std::min(size + kChunkBytes, kHeadBytes));
    got = source(head.data() + size, head.size() - size);
    head.resize(size + got);
  }
  if (head.size() == kHeadBytes) {  // there may be more: the last line is not whole
    const std::size_t end = head.rfind('\n');
    if (end != std::string::npos) head.resize(end);
  }
  return head;
}

struct Line {
  std::string_view text;
  char separator = ',';
  std::vector<std::string_view> cells = {};
  std::size_t values = 0;  // cells that are numbers, times or missing
};

bool IsValue(std::string_view cell, char separator) {
  std::string text(Unquoted(cell));
  if (separator != ',') std::ranges::replace(text, ',', '.');
  return NumberOrMissing(text).has_value() || SecondsOfText(cell).has_value();
}

std::vector<Line> LinesOf(std::string_view head) {
  std::vector<Line> lines;
  for (const std::string_view text : SplitLines(head)) {
    Line& line = lines.emplace_back(Line{.text = text});
    if (Trimmed(text).empty() || Trimmed(text).front() == '#') continue;
    line.separator = SeparatorOf(text);
    line.cells = SplitCells(text, line.separator);
    line.values = std::ranges::count_if(
        line.cells, [&](std::string_view cell) { return IsValue(cell, line.separator); });
  }
  return lines;
}

/// Of cells and separator: what most lines have.
std::pair<std::size_t, char> UsualShape(const std::vector<Line>& lines) {
  std::map<std::pair<std::size_t, char>, std::size_t> seen;
  for (const Line& line : lines) {
    if (line.values > 0) ++seen[{line.cells.size(), line.separator}];
  }
  const auto most =
      std::ranges::max_element(seen, {}, [](const auto& shape) { return shape.second; });
  return most == seen.end() ? std::pair(std::size_t{0}, ',') : most->first;
}

std::vector<std::string> TextsOf(const std::vector<std::string_view>& cells) {
  std::vector<std::string> texts;
  for (const std::string_view cell : cells) texts.emplace_back(Unquoted(cell));
  return texts;
}

/// The names in the lines above the first row, if they fit: the last of them is nearest.
void FindNames(const std::vector<Line>& lines, std::size_t first_row, TableLayout& layout) {
  std::size_t line = first_row;
  while (line-- > 0) {
    const Line& above = lines[line];
    std::string_view text = Trimmed(above.text);
    if (text.empty() && layout.names.empty()) continue;
    if (text.empty()) return;
    const bool is_comment = text.front() == '#';
    if (is_comment) text.remove_prefix(1);
    std::vector<std::string> names = TextsOf(SplitCells(Trimmed(text), layout.separator));
    if (is_comment && names.size() != layout.columns) {
      names = TextsOf(SplitCells(Trimmed(text), SeparatorOf(text)));
    }
    const bool one_short = names.size() + 1 == layout.columns && !is_comment;
    if (names.size() != layout.columns && !one_short) return;
    if (std::ranges::all_of(
            names, [&](const std::string& name) { return IsValue(name, layout.separator); })) {
      return;
    }
    const bool nearest = layout.names.empty();
    if (nearest) {
      layout.has_header = !is_comment;
      if (!is_comment) layout.skipped_lines = static_cast<int>(line);
      layout.names = names;
      if (one_short) {
        const bool time_is_first = TimeScaleS(names.front()).has_value();
        layout.names.insert(time_is_first ? layout.names.end() : layout.names.begin(), "");
        return;
      }
      continue;
    }
    if (std::ranges::any_of(
            names, [](const std::string& name) { return name.empty() || IsValue(name, ','); })) {
      return;
    }
    // Names above units: what is read by number has both in its name.
    for (std::size_t i = 0; i < names.size(); ++i)
      layout.names[i] = names[i] + " " + layout.names[i];
    layout.has_header = false;
    layout.skipped_lines = static_cast<int>(first_row);
    return;
  }
}

}  // namespace

TableLayout FindTable(const std::string& name, const CsvReader::Source& source) {
  const std::string head = HeadOf(source);
  const std::vector<Line> lines = LinesOf(head);
  const auto [columns, separator] = UsualShape(lines);
  TableLayout layout;
  layout.columns = columns;
  layout.separator = separator;
  const auto fits = [&, width = columns, between = separator](const Line& line) {
    return line.cells.size() == width && line.separator == between;
  };
  std::vector<std::size_t> values;
  for (const Line& line : lines) {
    if (fits(line)) values.push_back(line.values);
  }
  if (values.empty()) {
    throw UserError({.place = name, .problem = "holds no table of numbers"});
  }
  const std::size_t usual_values = controller::MedianOf(std::move(values));
  const auto is_row = [&](const Line& line) {
    return fits(line) && line.values > 0 && 2 * line.values >= usual_values;
  };
  // A line such as `Serial,17` stands alone.
  std::size_t first_row = 0;
  while (first_row + 1 < lines.size() &&
         !(is_row(lines[first_row]) && is_row(lines[first_row + 1]))) {
    ++first_row;
  }
  layout.skipped_lines = static_cast<int>(first_row);
  const auto is_blank = [](const Line& line) { return line.cells.empty(); };
  if (std::all_of(lines.begin(), lines.begin() + first_row, is_blank)) layout.skipped_lines = 0;
  FindNames(lines, first_row, layout);
  layout.names.resize(columns);
  for (int i = 0; i < layout.skipped_lines; ++i) {
    if (!Trimmed(lines[i].text).empty()) layout.notes.emplace_back(Trimmed(lines[i].text));
  }
  for (std::size_t i = first_row; i < lines.size() && layout.rows.size() < kMostRows; ++i) {
    if (fits(lines[i])) layout.rows.push_back(TextsOf(lines[i].cells));
  }
  const auto has_comma = [](const auto& row) {
    return std::ranges::any_of(row, [](const std::string& cell) {
      return cell.find(',') != std::string::npos && !SecondsOfText(cell);
    });
  };
  layout.decimal_comma = separator != ',' && std::ranges::any_of(layout.rows, has_comma);
  constexpr std::size_t kMostChannels = 64;
  if (layout.rows.size() < kMostChannels && columns > 4 * kMostChannels) {
    throw UserError(
        {.place = name,
         .problem = fmt::format("has a row per channel ({} rows of {} values); write it "
                                "with a column per channel",
                                layout.rows.size(), columns)});
  }
  return layout;
}

CellKind KindOf(const TableLayout& layout, std::size_t column) {
  std::size_t numbers = 0, times = 0, texts = 0;
  for (const auto& row : layout.rows) {
    const std::string& cell = row[column];
    if (!std::isnan(NumberIn(layout, cell))) {
      ++numbers;
    } else if (SecondsOfText(cell)) {
      ++times;
    } else if (!IsValue(cell, layout.separator)) {
      ++texts;
    }
  }
  if (texts > numbers + times) return CellKind::kText;
  return times > numbers ? CellKind::kTime : CellKind::kNumber;
}

double NumberIn(const TableLayout& layout, const std::string& cell) {
  std::string text = cell;
  if (layout.separator != ',') std::ranges::replace(text, ',', '.');
  return NumberOrMissing(text).value_or(controller::kNaN);
}

}  // namespace gauntlet::sim
