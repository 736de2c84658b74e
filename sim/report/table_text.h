#pragma once

#include <cstddef>
#include <limits>
#include <string>
#include <vector>

#include "sim/base/text.h"  // Width, for those who align
#include "sim/study/statistics.h"

namespace gauntlet::sim {

/// A score with three significant digits, which is what the intervals usually allow; "-" for NaN.
std::string Short(double value);

/// `text` filled up with spaces, on its left if it belongs on the right.
std::string Padded(const std::string& text, std::size_t width, bool right);

/// A mean and half of its interval, `4.96±0.12`; "-" where there is none.
std::string IntervalText(const MeanInterval& interval);

/// Rows of equally many fields, each column as wide as its widest, on the right.
std::string AlignedTable(const std::vector<std::vector<std::string>>& rows);

/// Colours of a terminal: what is good, and what to look at.
std::string Good(const std::string& text);
std::string Warning(const std::string& text);

/// What a terminal can show.
struct TerminalStyle {
  static constexpr std::size_t kNoLimit = std::numeric_limits<std::size_t>::max();

  std::size_t width = 80;        // columns of running text
  std::size_t table_width = 80;  // of tables; kNoLimit: in one piece
  bool colour = false;           // marks have terminal colours, too

  /// Of a page or a file, where lines may be as long as they are.
  static constexpr TerminalStyle Unlimited() { return {.table_width = kNoLimit}; }
};

/// In lines of at most `width` columns, broken at spaces; a longer word has its own line.
std::string Wrapped(const std::string& text, std::size_t width);

/// A column of a table. `rows`: per row of the table its lines. All is aligned on the right, with
/// room for a mark: `*` (good), `!` (look at it), or any other.
struct TableColumn {
  struct Line {
    std::string text;
    char mark = ' ';
  };
  std::vector<std::string> head;  // from the top
  std::vector<std::vector<Line>> rows;
};

/// How many columns of a terminal the table takes in one piece.
std::size_t TableWidth(const std::string& corner, const std::vector<std::string>& names,
                       const std::vector<TableColumn>& columns);

/// A table for a person: `corner` above the names of the rows, then the columns. Where they do not
/// fit beside each other in `style.table_width`, the rest follows below in pieces of their own,
/// with the names again. A name longer than a third of the width stands in a line of its own.
std::string TableText(const std::string& corner, const std::vector<std::string>& names,
                      const std::vector<TableColumn>& columns, const TerminalStyle& style);

/// AlignedTable() with the first row as heads. Where it is wider than `style.table_width`, it is a
/// TableText() whose rows have the first `names` fields as their name.
std::string AlignedTable(const std::vector<std::vector<std::string>>& rows,
                         const TerminalStyle& style, std::size_t names = 1);

}  // namespace gauntlet::sim
