#include "sim/tables/text_lines.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <iterator>
#include <optional>
#include <utility>

#include "sim/base/csv_line.h"
#include "sim/base/error.h"
#include "sim/tables/time_columns.h"

namespace gauntlet::sim {
namespace {

constexpr std::size_t kMostJoinedLines = 16;

/// A line whose texts in quotes are no more than quotes: separators in them separate nothing.
std::string OutsideQuotes(std::string_view line) {
  std::string outside;
  bool quoted = false;
  for (const char c : line) {
    quoted = quoted != (c == '"');
    if (!quoted || c == '"') outside += c;
  }
  return quoted ? std::string(line) : outside;  // one that does not close is a letter
}

/// A number or a missing value.
std::optional<double> PlainNumberIn(std::string_view cell, bool decimal_comma) {
  if (!decimal_comma) return NumberOrMissing(cell);
  std::string text(Unquoted(cell));
  std::ranges::replace(text, ',', '.');
  return NumberOrMissing(text);
}

/// False if a cell begins with a double quote and does not end with one.
bool ClosesItsQuotes(std::string_view line) {
  const std::vector<std::string_view> cells = SplitCells(line, SeparatorOf(line));
  return std::ranges::all_of(cells, [](std::string_view cell) {
    cell = Trimmed(cell);
    return !cell.starts_with('"') || (cell.size() > 1 && cell.ends_with('"'));
  });
}

/// Text of `source` with line feeds, if its lines end with CR alone: if something follows the first
/// CR and no LF is in sight.
TextLines::Source WithLineFeeds(TextLines::Source source) {
  enum class Ends { kUnknown, kUsual, kCarriageReturns };
  return
      [source = std::move(source), ends = Ends::kUnknown](char* buffer, std::size_t size) mutable {
        const std::size_t got = source(buffer, size);
        const std::string_view text(buffer, got);
        if (ends == Ends::kUnknown) {
          const std::size_t first = text.find('\r');
          if (text.find('\n') != std::string_view::npos) {
            ends = Ends::kUsual;
          } else if (text.find_first_not_of('\r', first) != std::string_view::npos) {
            ends = Ends::kCarriageReturns;
          }
        }
        if (ends == Ends::kCarriageReturns) std::replace(buffer, buffer + got, '\r', '\n');
        return got;
      };
}

}  // namespace

TextLines::TextLines(std::string name, Source source)
    : name_(std::move(name)),
      source_(WithLineFeeds(std::move(source))),
      buffer_(std::size_t{1} << 16) {}

void TextLines::Refill() {
  if (begin_ > 0) {
    std::memmove(buffer_.data(), buffer_.data() + begin_, end_ - begin_);
    end_ -= begin_;
    begin_ = 0;
  }
  if (end_ == buffer_.size()) {
    if (buffer_.size() >= kLongestLine) {
      throw UserError(
          {.place = fmt::format("{}:{}:1", name_, lines_read_ + 1), .problem = LineTooLong()});
    }
    buffer_.resize(buffer_.size() * 2);
  }
  const std::size_t got = source_(buffer_.data() + end_, buffer_.size() - end_);
  if (got == 0) source_is_empty_ = true;
  end_ += got;
}

bool TextLines::TakeFromBuffer(std::string_view& line) {
  std::size_t searched = 0;
  for (;;) {
    const char* start = buffer_.data() + begin_;
    const std::size_t size = end_ - begin_;
    const void* found = std::memchr(start + searched, '\n', size - searched);
    if (found != nullptr) {
      line = {start, static_cast<const char*>(found)};
      begin_ += line.size() + 1;
      break;
    }
    if (source_is_empty_) {
      if (size == 0) return false;
      line = {start, size};
      begin_ = end_;
      break;
    }
    searched = size;
    Refill();
  }
  number_ = ++lines_read_;
  if (number_ == 1) line = WithoutByteOrderMark(line);
  if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
  return true;
}

bool TextLines::Take(std::string_view& line) {
  if (given_back_.empty()) return TakeFromBuffer(line);
  current_ = std::move(given_back_.front().text);
  number_ = given_back_.front().number;
  given_back_.pop_front();
  line = current_;
  return true;
}

void TextLines::Complete(std::string_view& line) {
  std::vector<TextLine> taken = {{std::string(line), number_}};
  std::string joined(line);
  std::string_view next;
  while (taken.size() < kMostJoinedLines && Take(next)) {
    taken.push_back({std::string(next), number_});
    joined.append(" ").append(next);
    if (!ClosesItsQuotes(joined)) continue;
    taken.resize(1);
    taken.front().text = std::move(joined);
    break;
  }
  GiveBack(std::move(taken));
  Take(line);
}

bool TextLines::Next(std::string_view& line) {
  if (!Take(line)) return false;
  const bool has_quote = std::memchr(line.data(), '"', line.size()) != nullptr;
  // Rows of quoted numbers, each quote with its partner, are to stay quick.
  if (has_quote && std::ranges::count(line, '"') % 2 != 0 && !Trimmed(line).starts_with('#') &&
      !ClosesItsQuotes(line)) {
    Complete(line);
  }
  return true;
}

void TextLines::Skip(int lines) {
  std::string_view line;
  for (int skipped = 0; skipped < lines && Take(line); ++skipped) {
  }
}

void TextLines::GiveBack(std::vector<TextLine> lines) {
  given_back_.insert(given_back_.begin(), std::make_move_iterator(lines.begin()),
                     std::make_move_iterator(lines.end()));
}

char SeparatorOf(std::string_view text) {
  const std::string line = OutsideQuotes(text);
  for (const char candidate : {';', '\t'}) {
    if (line.find(candidate) != std::string_view::npos) return candidate;
  }
  const bool has_blank = Trimmed(line).find(' ') != std::string_view::npos;
  if (line.find(',') == std::string_view::npos) return has_blank ? ' ' : ',';
  if (!has_blank) return ',';
  const std::vector<std::string_view> cells = SplitCells(line, ' ');
  const auto is_decimal = [](std::string_view cell) {
    return !cell.starts_with(',') && !cell.ends_with(',') && PlainNumberIn(cell, true);
  };
  return std::ranges::all_of(cells, is_decimal) ? ' ' : ',';
}

std::optional<double> ValueIn(std::string_view cell, char separator) {
  const std::optional<double> number = PlainNumberIn(cell, separator != ',');
  return number ? number : SecondsOfText(cell);
}

bool IsValue(std::string_view cell, char separator) { return ValueIn(cell, separator).has_value(); }

}  // namespace gauntlet::sim
