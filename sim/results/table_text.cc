#include "sim/results/table_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <span>

#include "controller/assert.h"

namespace gauntlet::sim {
namespace {

constexpr std::size_t kGap = 2;  // in front of a column

std::string Coloured(const std::string& text, std::uint8_t colour) {
  return fmt::format("\033[38;5;{}m{}\033[0m", colour, text);
}

struct Line {
  std::string text;
  char mark = ' ';
};

/// The name of a row.
struct Name {
  std::string text;
  std::optional<std::uint8_t> colour;

  std::string Filled(std::size_t width, bool coloured) const {
    const std::string shown = colour && coloured ? Coloured(text, *colour) : text;
    return shown + std::string(width > Width(text) ? width - Width(text) : 0, ' ');
  }
};

/// A column as lines of text.
struct Column {
  bool is_right = true;           // numbers are
  std::vector<std::string> head;  // from the top
  std::vector<std::vector<Line>> rows;
  std::size_t width = 0;
  std::size_t mark_width = 0;  // 1 where a value has a mark

  std::size_t whole_width() const { return kGap + width + mark_width; }
};

/// The names of rows, in one column on the left.
struct Names {
  std::string corner;
  std::vector<Name> rows;
  std::size_t width = 0;  // but for names that have a line of their own
};

std::vector<std::string> LinesOf(const std::string& text, bool narrow) {
  std::vector<std::string> lines(1);
  for (const char c : text) {
    if (c == kBreak || (c == kSoftBreak && narrow)) {
      lines.back().erase(lines.back().find_last_not_of(' ') + 1);
      lines.emplace_back();
    } else if (c != kSoftBreak) {
      lines.back().push_back(c);
    }
  }
  return lines;
}

Column ColumnOf(const ResultTable& table, std::size_t c, bool narrow) {
  Column column{.is_right = !table.columns[c].is_words,
                .head = LinesOf(table.columns[c].heading, narrow),
                .rows = {}};
  if (!table.columns[c].unit.empty()) column.head.push_back(table.columns[c].unit);
  for (const std::string& line : column.head) column.width = std::max(column.width, Width(line));
  for (const ResultRow& row : table.rows) {
    std::vector<Line>& lines = column.rows.emplace_back();
    for (std::string& text : LinesOf(row[c].text, narrow)) {
      column.width = std::max(column.width, Width(text));
      lines.push_back({.text = std::move(text)});
    }
    lines.front().mark = row[c].mark;
    if (row[c].mark != ' ' && column.is_right) column.mark_width = 1;
  }
  return column;
}

/// The columns `places` side by side.
Names NamesOf(const ResultTable& table, std::span<const std::size_t> places, std::size_t longest) {
  Names names;
  names.rows.resize(table.rows.size());
  for (std::size_t i = 0; i < places.size(); ++i) {
    const std::size_t c = places[i];
    const std::string gap(i == 0 ? 0 : kGap, ' ');
    std::size_t width = Width(table.columns[c].heading);
    for (const ResultRow& row : table.rows) width = std::max(width, Width(row[c].text));
    const auto filled = [&](const std::string& text) {
      return gap + (i + 1 < places.size() ? Padded(text, width, false) : text);
    };
    names.corner += filled(table.columns[c].heading);
    for (std::size_t r = 0; r < table.rows.size(); ++r) {
      names.rows[r].text += filled(table.rows[r][c].text);
      names.rows[r].colour = table.rows[r][c].terminal_colour;
    }
  }
  names.width = Width(names.corner);
  for (const Name& name : names.rows) {
    if (Width(name.text) <= longest) names.width = std::max(names.width, Width(name.text));
  }
  return names;
}

std::string Decorated(const Line& line, const Column& column, bool colour) {
  std::string text =
      Padded(line.text, column.width, column.is_right) + std::string(column.mark_width, line.mark);
  if (colour && line.mark == '!') return Warning(text);
  if (colour && line.mark == '*') return Good(text);
  return text;
}

void AppendLine(std::string& out, std::string line) {
  line.erase(line.find_last_not_of(' ') + 1);
  out += line + "\n";
}

void AppendHead(const Names& names, std::span<const Column> columns, std::string& out) {
  std::size_t lines = 1;
  for (const Column& column : columns) lines = std::max(lines, column.head.size());
  for (std::size_t left = lines; left > 0; --left) {  // heads stand on the first row
    std::string text = Padded(left > 1 ? "" : names.corner, names.width, false);
    for (const Column& column : columns) {
      const auto& head = column.head;
      text += std::string(kGap, ' ') + Padded(left > head.size() ? "" : head[head.size() - left],
                                              column.width, column.is_right);
      text += std::string(column.mark_width, ' ');
    }
    AppendLine(out, text);
  }
}

void AppendPiece(const Names& names, std::span<const Column> columns, bool colour,
                 std::string& out) {
  AppendHead(names, columns, out);
  for (std::size_t row = 0; row < names.rows.size(); ++row) {
    const Name& name = names.rows[row];
    const bool own_line = Width(name.text) > names.width;
    if (own_line) AppendLine(out, name.Filled(0, colour));
    std::size_t lines = 1;
    for (const Column& column : columns) lines = std::max(lines, column.rows[row].size());
    for (std::size_t line = 0; line < lines; ++line) {
      std::string text = (line == 0 && !own_line ? name : Name{}).Filled(names.width, colour);
      for (const Column& column : columns) {
        const auto& cells = column.rows[row];
        text += std::string(kGap, ' ') +
                Decorated(line < cells.size() ? cells[line] : Line{}, column, colour);
      }
      AppendLine(out, text);
    }
  }
}

std::size_t WholeWidth(std::size_t names, std::span<const Column> columns) {
  for (const Column& column : columns) names += column.whole_width();
  return names;
}

/// The paragraphs, each in lines of its own.
std::string Paragraphs(const std::string& text, std::size_t width) {
  std::string out;
  for (const std::string& line : LinesOf(text, false)) out += Wrapped(line, width) + "\n";
  return out;
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

std::string Counted(std::int64_t count, std::string_view noun) {
  return fmt::format("{} {}{}", count, noun, count == 1 ? "" : "s");
}

std::string Listed(std::vector<std::string> items) {
  std::erase(items, "");
  std::string text;
  for (std::size_t i = 0; i < items.size(); ++i) {
    text += (i == 0 ? "" : i + 1 < items.size() ? ", " : " and ") + items[i];
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

std::string TextOf(const ResultTable& table, const TerminalStyle& style) {
  std::vector<std::size_t> shown;
  for (std::size_t c = 0; c < table.columns.size(); ++c) {
    if (!table.columns[c].heading.empty()) shown.push_back(c);
  }
  GAUNTLET_ASSERT(table.names >= 1 && table.names <= shown.size());
  const std::span<const std::size_t> all = shown;
  const Names names = NamesOf(table, all.first(table.names), style.table_width / 3);
  std::vector<Column> columns;
  for (const bool narrow : {false, true}) {
    columns.clear();
    for (const std::size_t c : all.subspan(table.names)) {
      columns.push_back(ColumnOf(table, c, narrow));
    }
    if (WholeWidth(names.width, columns) <= style.table_width) break;
  }
  std::string out;
  std::span<const Column> rest = columns;
  do {
    std::size_t count = std::min<std::size_t>(1, rest.size());
    while (count < rest.size() &&
           WholeWidth(names.width, rest.first(count + 1)) <= style.table_width) {
      ++count;
    }
    if (!out.empty()) out += "\n";
    AppendPiece(names, rest.first(count), style.colour, out);
    rest = rest.subspan(count);
  } while (!rest.empty());
  return out;
}

std::string TextOf(const ResultText& result, const TerminalStyle& style) {
  std::string out;
  for (const auto& part : result) {
    std::string text;
    if (const auto* table = std::get_if<ResultTable>(&part)) {
      text = table->rows.empty() ? "" : TextOf(*table, style);
    } else if (const auto* lines = std::get_if<CommandLines>(&part)) {
      text = lines->text;
    } else if (const auto& paragraphs = std::get<std::string>(part); !paragraphs.empty()) {
      text = Paragraphs(paragraphs, style.width);
    }
    if (!out.empty() && !text.empty()) out += "\n";
    out += text;
  }
  return out;
}

void AddVerdict(const Verdict& verdict, ResultText& result) {
  result.emplace_back(std::string());
  for (const std::string& sentence : verdict.Answer()) AddLine(sentence, result);
  for (const std::string& doubt : verdict.Doubts()) AddLine("Warning: " + doubt, result);
}

void AddLine(const std::string& paragraph, ResultText& result) {
  if (paragraph.empty()) return;
  if (result.empty() || !std::holds_alternative<std::string>(result.back())) {
    result.emplace_back(std::string());
  }
  std::string& text = std::get<std::string>(result.back());
  text += (text.empty() ? "" : std::string(1, kBreak)) + paragraph;
}

}  // namespace gauntlet::sim
