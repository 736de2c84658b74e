#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "sim/base/text.h"  // Width, for those who align
#include "sim/results/result_table.h"
#include "sim/results/verdict.h"

namespace gauntlet::sim {

/// A number with three significant digits, which is what the intervals usually allow; "-" for NaN.
std::string Short(double value);

/// `text` filled up with spaces, on its left if it belongs on the right.
std::string Padded(const std::string& text, std::size_t width, bool right);

/// Colours of a terminal: what is good, and what to look at.
std::string Good(const std::string& text);
std::string Warning(const std::string& text);

/// "1 seed", "8 seeds".
std::string Counted(std::int64_t count, std::string_view noun);

/// "a", "a and b", "a, b and c"; empty ones are left out.
std::string Listed(std::vector<std::string> items);

/// Abilities of a terminal.
struct TerminalStyle {
  static constexpr std::size_t kNoLimit = std::numeric_limits<std::size_t>::max();

  std::size_t width = 80;        // columns of running text
  std::size_t table_width = 80;  // of tables; kNoLimit: in one piece
  bool colour = false;           // marks have terminal colours, too

  /// Style of a file, whose lines may be as long as they are.
  static constexpr TerminalStyle Unlimited() { return {.table_width = kNoLimit}; }
};

/// In lines of at most `width` columns, broken at spaces; a longer word has its own line.
std::string Wrapped(const std::string& text, std::size_t width);

/// The columns with a heading. Names are on the left, all else on the right. Where the columns do
/// not fit beside each other in `style.table_width`, texts are broken at kSoftBreak; where that is
/// not enough, the rest follows below in pieces of their own, with the names again. A name longer
/// than a third of the width has a line of its own.
std::string TextOf(const ResultTable& table, const TerminalStyle& style);

/// Lines to copy, which stay as they are.
struct CommandLines {
  std::string text;
};

/// Result as a person reads it, from the top. Text: a line of it is a paragraph.
using ResultText = std::vector<std::variant<std::string, ResultTable, CommandLines>>;

/// The parts with an empty line between them; empty ones are left out.
std::string TextOf(const ResultText& result, const TerminalStyle& style);

/// Adds the answer of a verdict, and its doubts as warnings, as one text.
void AddVerdict(const Verdict& verdict, ResultText& result);

/// Adds a paragraph to the text at the end of `result`; an empty one changes nothing.
void AddLine(const std::string& paragraph, ResultText& result);

}  // namespace gauntlet::sim
