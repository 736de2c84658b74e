#include "sim/tables/table_layout.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <string_view>
#include <utility>

#include "controller/calibration/robust_statistics.h"
#include "controller/number.h"
#include "sim/base/csv_line.h"
#include "sim/base/error.h"
#include "sim/tables/text_lines.h"
#include "sim/tables/time_columns.h"

namespace gauntlet::sim {
namespace {

constexpr std::size_t kHeadBytes = std::size_t{256} << 10;
constexpr std::size_t kMostRows = 2000;

struct Line {
  TextLine line;
  char separator = ',';
  std::vector<std::string_view> cells = {};  // none: a line without any entry, or a comment
  std::size_t values = 0;                    // cells with a number, a time or a missing value
  std::size_t filled = 0;                    // those of them that are not empty
};

/// Drops the empty cell behind a final separator where other lines of one cell less have none.
void DropEmptyEnds(std::vector<Line>& lines) {
  std::set<std::size_t> widths;
  for (const Line& line : lines) {
    if (line.filled > 0 && !Unquoted(line.cells.back()).empty()) widths.insert(line.cells.size());
  }
  for (Line& line : lines) {
    if (line.filled == 0 || line.values < line.cells.size() ||
        !Unquoted(line.cells.back()).empty() || !widths.contains(line.cells.size() - 1) ||
        widths.contains(line.cells.size())) {
      continue;
    }
    line.cells.pop_back();
    --line.values;
  }
}

std::vector<Line> LinesOf(std::string_view head) {
  if (head.size() == kHeadBytes) {  // probably cut: the last line may be incomplete
    const std::size_t end = head.rfind('\n');
    head = head.substr(0, end == std::string_view::npos ? head.rfind('\r') : end);
  }
  TextLines text("", TextSource(head));
  std::vector<Line> lines;
  for (std::string_view line; text.Next(line);) {
    lines.push_back({.line = {std::string(line), text.number()}});
  }
  for (Line& line : lines) {
    const std::string_view trimmed = Trimmed(line.line.text);
    if (trimmed.empty() || trimmed.front() == '#') continue;
    line.separator = SeparatorOf(line.line.text);
    line.cells = SplitCells(line.line.text, line.separator);
    const auto is_empty = [](std::string_view cell) { return Unquoted(cell).empty(); };
    if (std::ranges::all_of(line.cells, is_empty)) line.cells.clear();
    line.values = std::ranges::count_if(
        line.cells, [&](std::string_view cell) { return IsValue(cell, line.separator); });
    line.filled = std::ranges::count_if(line.cells, [&](std::string_view cell) {
      return !is_empty(cell) && IsValue(cell, line.separator);
    });
  }
  DropEmptyEnds(lines);
  return lines;
}

[[noreturn]] void FailWithoutTable(const std::string& name) {
  throw UserError({.place = name, .problem = "holds no table of numbers"});
}

/// Number of cells and separator of most lines; the larger number on a tie. None if no line has a
/// value.
std::optional<std::pair<std::size_t, char>> UsualShape(const std::vector<Line>& lines) {
  std::map<std::pair<std::size_t, char>, std::size_t> seen;
  for (const Line& line : lines) {
    if (line.filled > 0) ++seen[{line.cells.size(), line.separator}];
  }
  const auto most = std::ranges::max_element(
      seen, {}, [](const auto& shape) { return std::pair(shape.second, shape.first.first); });
  if (most == seen.end()) return std::nullopt;
  return most->first;
}

std::vector<std::string> TextsOf(const std::vector<std::string_view>& cells) {
  std::vector<std::string> texts;
  for (const std::string_view cell : cells) texts.emplace_back(Unquoted(cell));
  return texts;
}

/// True for a row of values that lacks the last one, or has a text behind it: where only some rows
/// have a remark.
bool IsNearlyRow(const Line& line, const TableLayout& layout) {
  const std::size_t cells = line.cells.size();
  const bool is_narrow = cells > 1 && cells + 1 == layout.columns && line.values == cells;
  const bool is_wide = cells == layout.columns + 1 && line.values + 1 == cells &&
                       !IsValue(line.cells.back(), line.separator);
  return line.separator == layout.separator && (is_narrow || is_wide);
}

/// First of the rows that have entries in most cells: the first line with another row directly
/// below it (a line such as `Serial,17` has none). Else the first one with only empty lines and
/// comments before the next row, else the last row.
std::size_t FirstRow(const std::vector<Line>& lines, const std::vector<std::size_t>& rows,
                     const TableLayout& layout) {
  std::optional<std::size_t> apart;
  for (std::size_t i = 0; i + 1 < rows.size(); ++i) {
    if (rows[i] + 1 == rows[i + 1] || IsNearlyRow(lines[rows[i] + 1], layout)) return rows[i];
    const bool is_next = std::all_of(lines.begin() + rows[i] + 1, lines.begin() + rows[i + 1],
                                     [](const Line& line) { return line.cells.empty(); });
    if (is_next && !apart) apart = rows[i];
  }
  return apart.value_or(rows.back());
}

/// The names above with each group's, which stands above its first column, above all of them; as
/// they are if the names below tell the columns apart without groups.
std::vector<std::string> WithGroups(std::vector<std::string> above,
                                    const std::vector<std::string>& below) {
  const std::set<std::string> different(below.begin(), below.end());
  if (different.size() == below.size()) return above;
  for (std::size_t i = 1; i < above.size(); ++i) {
    if (above[i].empty()) above[i] = above[i - 1];
  }
  return above;
}

bool AreValues(const std::vector<std::string>& names, char separator) {
  return std::ranges::all_of(
      names, [separator](const std::string& name) { return IsValue(name, separator); });
}

/// The cells of a line above the table, and whether the reader may take it as its header.
struct NamesAbove {
  std::vector<std::string> names;
  bool is_header = false;
};

/// Empty if the line has another number of cells than the table. The `nearest` line may have one
/// name too few or too many.
NamesAbove NamesIn(const Line& line, bool nearest, const TableLayout& layout) {
  std::string_view text = Trimmed(line.line.text);
  const bool is_comment = text.front() == '#';
  if (is_comment) text.remove_prefix(1);
  const auto fits = [&](std::size_t names) {
    if (is_comment || !nearest) return names == layout.columns;
    return names + 1 >= layout.columns && names <= layout.columns + 1;
  };
  // Cut as the reader does it, or else only to find the names.
  NamesAbove above;
  above.is_header = !is_comment && line.separator == layout.separator &&
                    line.cells.size() <= layout.columns && fits(line.cells.size());
  above.names = TextsOf(above.is_header ? line.cells : SplitCells(Trimmed(text), layout.separator));
  if (is_comment && above.names.size() != layout.columns) {
    above.names = TextsOf(SplitCells(Trimmed(text), SeparatorOf(text)));
  }
  if (!fits(above.names.size())) above.names.clear();
  return above;
}

/// True for a line inside the table that names columns, and not in the same way: with half of the
/// names or more, or behind an empty line.
bool NamesAgain(const Line& line, bool is_behind_empty, const std::vector<std::string>& names) {
  if (line.values > 0) return false;
  const std::vector<std::string> texts = TextsOf(line.cells);
  const std::set<std::string> different(texts.begin(), texts.end());
  const auto known = std::ranges::count_if(different, [&names](const std::string& text) {
    return !text.empty() && std::ranges::find(names, text) != names.end();
  });
  return different.size() == texts.size() && texts != names &&
         (is_behind_empty || (known > 0 && 2 * known >= std::ssize(names)));
}

/// Errors: UserError for names above about twice as many whole numbers between commas.
void CheckDecimalCommas(const std::string& name, const Line& names, const Line& row) {
  const std::size_t count = names.cells.size();
  const bool are_whole = std::ranges::all_of(row.cells, [](std::string_view cell) {
    return controller::ParseWholeNumber(cell, INT64_MIN / 2, INT64_MAX / 2).has_value();
  });
  if (names.values > 0 || count < 2 || names.separator != ',' || row.separator != ',' ||
      row.cells.size() <= count + 1 || row.cells.size() > 2 * count || !are_whole) {
    return;
  }
  throw UserError(
      {.place = name,
       .problem = fmt::format(
           "has {} names above {} values; are there decimal commas between commas? Write decimal "
           "points, or semicolons between the columns",
           count, row.cells.size())});
}

/// Errors: UserError for names above the table of which there are rows, but not those of the table,
/// which have another number of values: as where a row has one hand or two.
void CheckWidths(const std::string& name, const std::vector<Line>& lines, std::size_t first_row,
                 const TableLayout& layout) {
  for (std::size_t i = 0; i < first_row; ++i) {
    const std::size_t count = lines[i].cells.size();
    constexpr std::size_t kFewestNames = 3;
    const std::size_t apart = std::max(count, layout.columns) - std::min(count, layout.columns);
    const bool are_names = lines[i].values == 0 && count >= kFewestNames &&
                           std::ranges::none_of(lines[i].cells, [](std::string_view cell) {
                             return Unquoted(cell).empty();
                           });
    if (!are_names || apart < 2) continue;
    const auto rows = std::ranges::count_if(lines, [count](const Line& line) {
      return line.cells.size() == count && line.values == count;
    });
    constexpr std::ptrdiff_t kSeldom = 50;
    if (kSeldom * rows < std::ssize(lines)) continue;
    throw UserError({.place = name,
                     .problem = fmt::format(
                         "has rows of {} and of {} values, and the header names {}; write "
                         "the rows of each kind to a file",
                         std::min(count, layout.columns), std::max(count, layout.columns), count)});
  }
}

/// True for a line with the name of the first column alone, as pandas writes it below the names of
/// all others.
bool NamesFirstOnly(const std::vector<std::string>& names) {
  constexpr std::size_t kFewest = 3;
  return names.size() >= kFewest && !names.front().empty() &&
         std::all_of(names.begin() + 1, names.end(),
                     [](const std::string& name) { return name.empty(); });
}

/// Finds the column names in the lines above the first row, beginning with the nearest.
void FindNames(const std::string& file, const std::vector<Line>& lines, std::size_t first_row,
               TableLayout& layout) {
  std::string first_name;
  const auto use_numbers = [&] {  // of columns, as the names are of several lines
    layout.has_header = false;
    layout.skipped_lines = static_cast<int>(lines[first_row].line.number - 1);
    if (!first_name.empty()) layout.names.front() = first_name;
  };
  std::size_t line = first_row;
  while (line-- > 0) {
    const bool nearest = layout.names.empty();
    const std::string_view text = Trimmed(lines[line].line.text);
    const bool is_empty = lines[line].cells.empty() && !text.starts_with('#');
    if (is_empty && nearest) continue;
    if (is_empty) return;
    if (nearest) CheckDecimalCommas(file, lines[line], lines[first_row]);
    auto [names, is_header] = NamesIn(lines[line], nearest, layout);
    if (names.empty() || AreValues(names, layout.separator)) return;
    if (nearest && line > 0 && first_name.empty() && NamesFirstOnly(names) &&
        lines[line - 1].filled == 0 && lines[line - 1].cells.size() == names.size()) {
      first_name = names.front();
      continue;
    }
    if (nearest && !first_name.empty()) {
      layout.names = std::move(names);
      use_numbers();
      continue;
    }
    if (nearest) {
      layout.has_header = is_header;
      if (is_header) layout.skipped_lines = static_cast<int>(lines[line].line.number - 1);
      if (names.size() > layout.columns) {
        layout.extra_name = names.back().empty() ? "''" : names.back();
        // The reader counts the columns of its first line.
        const auto begin =
            std::find_if(lines.begin() + static_cast<std::ptrdiff_t>(first_row), lines.end(),
                         [&layout](const Line& row) { return row.cells.size() == layout.columns; });
        layout.skipped_lines = static_cast<int>(begin->line.number - 1);
        names.pop_back();
        layout.names = std::move(names);
        return;
      }
      const bool is_short = names.size() < layout.columns;
      const bool time_is_first = TimeScaleS(names.front()).has_value();
      if (is_short) names.insert(time_is_first ? names.end() : names.begin(), "");
      layout.names = std::move(names);
      if (is_short) return;
      continue;
    }
    names = WithGroups(std::move(names), layout.names);
    // The first column may be an index without a name.
    if (std::any_of(names.begin() + 1, names.end(),
                    [](const std::string& name) { return name.empty() || IsValue(name, ','); })) {
      return;
    }
    // Names above units, or groups above names: both are joined.
    for (std::size_t i = 0; i < names.size(); ++i) {
      const bool is_one = names[i].empty() || layout.names[i].empty();
      names[i] += (is_one ? "" : " ") + layout.names[i];
    }
    layout.names = std::move(names);
    use_numbers();
    return;
  }
}

/// The first line for the reader, and the names in the lines above.
TableLayout LayoutOf(const std::string& name, const std::vector<Line>& lines) {
  const auto shape = UsualShape(lines);
  if (!shape) FailWithoutTable(name);
  TableLayout layout;
  layout.columns = shape->first;
  layout.separator = shape->second;
  const auto fits = [&](const Line& line) {
    return line.cells.size() == layout.columns && line.separator == layout.separator;
  };
  std::vector<std::size_t> entries;
  for (const Line& line : lines) {
    if (fits(line)) entries.push_back(line.filled);
  }
  const std::size_t usual = controller::MedianOf(std::move(entries));
  std::vector<std::size_t> rows;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const std::size_t in_line = lines[i].filled;
    if (fits(lines[i]) && in_line > 0 && 2 * in_line >= usual) rows.push_back(i);
  }
  std::size_t first_row = FirstRow(lines, rows, layout);
  CheckWidths(name, lines, first_row, layout);
  // Rows in which most is missing yet. A line with a text is none.
  const auto is_row = [&](const Line& line) { return fits(line) && line.values == layout.columns; };
  while (first_row > 0 && is_row(lines[first_row - 1])) --first_row;
  // Up to the line of names, as many or one more for remarks.
  std::size_t below_names = first_row;
  while (below_names > 0 &&
         (is_row(lines[below_names - 1]) || IsNearlyRow(lines[below_names - 1], layout))) {
    --below_names;
  }
  if (below_names > 0 && lines[below_names - 1].values == 0 &&
      (fits(lines[below_names - 1]) || lines[below_names - 1].cells.size() == layout.columns + 1)) {
    first_row = below_names;
  }
  for (std::size_t i = 0; i < first_row; ++i) {
    const bool is_other = lines[i].filled > 1 && lines[i].values == lines[i].cells.size();
    layout.rows_before += is_other ? 1 : 0;
  }
  const bool is_first = std::all_of(lines.begin(), lines.begin() + first_row, [](const Line& line) {
    const std::string_view text = Trimmed(line.line.text);
    return text.empty() || text.front() == '#';
  });
  layout.skipped_lines = is_first ? 0 : static_cast<int>(lines[first_row].line.number - 1);
  FindNames(name, lines, first_row, layout);
  for (std::size_t i = first_row + 1; i < lines.size() && layout.second_names_line == 0; ++i) {
    if (fits(lines[i]) && NamesAgain(lines[i], lines[i - 1].cells.empty(), layout.names)) {
      layout.second_names_line = lines[i].line.number;
    }
  }
  for (std::size_t i = 0; i < first_row; ++i) {
    const std::string_view text = Trimmed(lines[i].line.text);
    const bool is_skipped = lines[i].line.number <= static_cast<std::size_t>(layout.skipped_lines);
    if (!text.empty() && (is_skipped || text.front() == '#')) layout.notes.emplace_back(text);
  }
  return layout;
}

}  // namespace

FoundTable FindTable(const std::string& name, TableInput input, ProblemHandling handling,
                     CsvReader::Listener listener) {
  if (!std::holds_alternative<CsvReader::Source>(input)) {
    CsvReader reader(name, std::move(input), handling, std::move(listener));
    TableLayout layout;
    layout.has_header = true;
    layout.columns = reader.column_count();
    layout.names = reader.header();
    layout.rows = reader.FirstRows(kMostRows, 0, kHeadBytes);
    return {.layout = std::move(layout), .reader = std::move(reader)};
  }
  CsvReader::Source source = std::get<CsvReader::Source>(std::move(input));
  std::string head = BytesOf(source, kHeadBytes);
  const std::vector<Line> lines = LinesOf(head);
  TableLayout layout = LayoutOf(name, lines);
  CsvReader reader(name, WithHead(std::move(head), std::move(source)), handling,
                   std::move(listener), layout.skipped_lines);
  layout.separator = reader.separator();
  layout.columns = reader.column_count();
  layout.has_header = layout.has_header && !reader.header().empty();
  if (layout.has_header) layout.names = reader.header();
  layout.names.resize(layout.columns);
  layout.rows = reader.FirstRows(kMostRows, lines.back().line.number, kHeadBytes);
  if (layout.rows.empty()) FailWithoutTable(name);
  const auto has_comma = [](const auto& row) {
    return std::ranges::any_of(row, [](const std::string& cell) {
      return cell.find(',') != std::string::npos && !SecondsOfText(cell);
    });
  };
  layout.decimal_comma = layout.separator != ',' && std::ranges::any_of(layout.rows, has_comma);
  constexpr std::size_t kMostChannels = 64;
  const auto is_name = [](const std::string& cell) { return !cell.empty() && !IsValue(cell, ','); };
  const bool has_names =
      2 * static_cast<std::size_t>(std::ranges::count_if(layout.names, is_name)) > layout.columns;
  if (!has_names && layout.rows.size() < kMostChannels && layout.columns > 4 * kMostChannels) {
    throw UserError(
        {.place = name,
         .problem = fmt::format("has a row per channel ({} rows of {} values); write it "
                                "with a column per channel",
                                layout.rows.size(), layout.columns)});
  }
  return {.layout = std::move(layout), .reader = std::move(reader)};
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
