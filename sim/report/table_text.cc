#include "sim/report/table_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <span>

namespace gauntlet::sim {
namespace {

constexpr std::size_t kGap = 2;  // in front of a column

struct ColumnWidth {
  std::size_t text = 0;
  std::size_t mark = 0;  // 1 where a value has one

  std::size_t whole() const { return kGap + text + mark; }
};

ColumnWidth WidthOf(const TableColumn& column) {
  ColumnWidth width;
  for (const std::string& line : column.head) width.text = std::max(width.text, Width(line));
  for (const auto& row : column.rows) {
    for (const auto& line : row) {
      width.text = std::max(width.text, Width(line.text));
      if (line.mark != ' ') width.mark = 1;
    }
  }
  return width;
}

/// How wide the names of rows are, but for those that have a line of their own.
std::size_t WidthOfNames(const std::string& corner, const std::vector<std::string>& names,
                         std::size_t longest) {
  std::size_t width = Width(corner);
  for (const std::string& name : names) {
    if (Width(name) <= longest) width = std::max(width, Width(name));
  }
  return width;
}

std::string Decorated(const TableColumn::Line& line, ColumnWidth width, bool colour) {
  std::string text = Padded(line.text, width.text, true) + std::string(width.mark, line.mark);
  if (colour && line.mark == '!') return Warning(text);
  if (colour && line.mark == '*') return Good(text);
  return text;
}

void AppendLine(std::string& out, std::string line) {
  line.erase(line.find_last_not_of(' ') + 1);
  out += line + "\n";
}

void AppendPiece(const std::string& corner, const std::vector<std::string>& names,
                 std::size_t name_width, std::span<const TableColumn> columns, bool colour,
                 std::string& out) {
  std::vector<ColumnWidth> widths;
  for (const TableColumn& column : columns) widths.push_back(WidthOf(column));
  std::size_t head_lines = 1;
  for (const TableColumn& column : columns) head_lines = std::max(head_lines, column.head.size());
  for (std::size_t left = head_lines; left > 0; --left) {  // heads stand on the first row
    std::string text = Padded(left > 1 ? "" : corner, name_width, false);
    for (std::size_t i = 0; i < columns.size(); ++i) {
      const auto& head = columns[i].head;
      text +=
          Padded(left > head.size() ? "" : head[head.size() - left], kGap + widths[i].text, true);
      text += std::string(widths[i].mark, ' ');
    }
    AppendLine(out, text);
  }
  for (std::size_t row = 0; row < names.size(); ++row) {
    const bool own_line = Width(names[row]) > name_width;
    if (own_line) AppendLine(out, names[row]);
    std::size_t lines = 0;
    for (const TableColumn& column : columns) lines = std::max(lines, column.rows[row].size());
    for (std::size_t line = 0; line < lines; ++line) {
      std::string text = Padded(line == 0 && !own_line ? names[row] : "", name_width, false);
      for (std::size_t i = 0; i < columns.size(); ++i) {
        const auto& cells = columns[i].rows[row];
        const TableColumn::Line cell = line < cells.size() ? cells[line] : TableColumn::Line{};
        text += std::string(kGap, ' ') + Decorated(cell, widths[i], colour);
      }
      AppendLine(out, text);
    }
  }
}

}  // namespace

std::string Short(double value) {
  if (!std::isfinite(value)) return "-";
  const double size = std::abs(value);
  const int decimals = size >= 99.95 ? 0 : size >= 9.995 ? 1 : size >= 0.9995 ? 2 : 3;
  return fmt::format("{:.{}f}", value, decimals);
}

std::string Padded(const std::string& text, std::size_t width, bool right) {
  const std::string space(width > Width(text) ? width - Width(text) : 0, ' ');
  return right ? space + text : text + space;
}

std::string IntervalText(const MeanInterval& interval) {
  if (std::isnan(interval.mean)) return "-";
  if (std::isnan(interval.high)) return fmt::format("{:.3g}", interval.mean);
  return fmt::format("{:.3g}±{:.2g}", interval.mean, interval.high - interval.mean);
}

std::string AlignedTable(const std::vector<std::vector<std::string>>& rows) {
  std::vector<std::size_t> widths(rows.front().size());
  for (const auto& row : rows) {
    for (std::size_t c = 0; c < row.size(); ++c) widths[c] = std::max(widths[c], Width(row[c]));
  }
  std::string text;
  for (const auto& row : rows) {
    for (std::size_t c = 0; c < row.size(); ++c) {
      text += (c == 0 ? "" : "  ") + std::string(widths[c] - Width(row[c]), ' ') + row[c];
    }
    text += "\n";
  }
  return text;
}

std::string Good(const std::string& text) { return "\033[1;32m" + text + "\033[0m"; }
std::string Warning(const std::string& text) { return "\033[33m" + text + "\033[0m"; }

std::string Wrapped(const std::string& text, std::size_t width) {
  std::string wrapped;
  std::size_t used = 0;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find(' ', begin), text.size());
    const std::string word = text.substr(begin, end - begin);
    if (used > 0 && used + 1 + Width(word) > width) {
      wrapped += '\n';
      used = 0;
    }
    if (used > 0) wrapped += ' ';
    wrapped += word;
    used += (used > 0 ? 1 : 0) + Width(word);
    begin = end + 1;
  }
  return wrapped;
}

std::size_t TableWidth(const std::string& corner, const std::vector<std::string>& names,
                       const std::vector<TableColumn>& columns) {
  std::size_t width = WidthOfNames(corner, names, TerminalStyle::kNoLimit);
  for (const TableColumn& column : columns) width += WidthOf(column).whole();
  return width;
}

std::string TableText(const std::string& corner, const std::vector<std::string>& names,
                      const std::vector<TableColumn>& columns, const TerminalStyle& style) {
  const std::size_t name_width = WidthOfNames(corner, names, style.table_width / 3);
  std::string out;
  const std::span<const TableColumn> all = columns;
  for (std::size_t begin = 0; begin < all.size();) {
    std::size_t end = begin + 1;
    std::size_t width = name_width + WidthOf(all[begin]).whole();
    for (; end < all.size() && width + WidthOf(all[end]).whole() <= style.table_width; ++end) {
      width += WidthOf(all[end]).whole();
    }
    if (begin > 0) out += "\n";
    AppendPiece(corner, names, name_width, all.subspan(begin, end - begin), style.colour, out);
    begin = end;
  }
  return out;
}

std::string AlignedTable(const std::vector<std::vector<std::string>>& rows,
                         const TerminalStyle& style, std::size_t names) {
  const std::size_t count = rows.front().size();
  std::vector<std::size_t> widths(count);
  for (const auto& row : rows) {
    for (std::size_t c = 0; c < count; ++c) widths[c] = std::max(widths[c], Width(row[c]));
  }
  const std::size_t whole = std::accumulate(widths.begin(), widths.end(), kGap * (count - 1));
  if (whole <= style.table_width) return AlignedTable(rows);
  std::vector<std::string> row_names;
  for (const auto& row : rows) {
    std::string& name = row_names.emplace_back();
    for (std::size_t c = 0; c < names; ++c) {
      name += std::string(c == 0 ? 0 : kGap, ' ') + Padded(row[c], widths[c], false);
    }
  }
  std::vector<TableColumn> columns;
  for (std::size_t c = names; c < count; ++c) {
    TableColumn& column = columns.emplace_back(TableColumn{.head = {rows[0][c]}, .rows = {}});
    for (std::size_t r = 1; r < rows.size(); ++r) {
      column.rows.push_back({TableColumn::Line{.text = rows[r][c]}});
    }
  }
  return TableText(row_names.front(), {row_names.begin() + 1, row_names.end()}, columns, style);
}

}  // namespace gauntlet::sim
