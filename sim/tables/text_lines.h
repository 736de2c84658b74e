#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "sim/base/error.h"

namespace gauntlet::sim {

struct TextLine {
  std::string text;        // without its end
  std::size_t number = 0;  // in the file, from 1
};

/// Gives a text line by line, with a fixed buffer, so that memory does not grow with the text.
///
/// Ends are LF, CRLF or CR; the byte order mark is left out. A cell in quotes may contain ends
/// of lines (RFC 4180): up to 16 lines are one then, with a blank in place of each end. A quote
/// that no line closes is a letter. Lines that begin with '#' are never joined.
class TextLines {
 public:
  /// Fills a buffer and says how many bytes it gave; 0 is the end.
  using Source = std::function<std::size_t(char* buffer, std::size_t size)>;

  /// `name` stands for the file in messages.
  TextLines(std::string name, Source source);

  const std::string& name() const { return name_; }
  /// Passes over the first lines of the file.
  void Skip(int lines);
  /// False at the end. `line` is valid until the next call.
  /// Errors: UserError `file:line:1: ...` for one of more than 1 MB.
  bool Next(std::string_view& line);
  /// Number of the line that Next() gave last, from 1: of the first one, if it is several.
  std::size_t number() const { return number_; }
  /// Next() gives these again, before all others.
  void GiveBack(std::vector<TextLine> lines);

 private:
  bool Take(std::string_view& line);
  bool TakeFromBuffer(std::string_view& line);
  void Refill();
  void Complete(std::string_view& line);

  std::string name_;
  Source source_;
  std::vector<char> buffer_;
  std::size_t begin_ = 0;
  std::size_t end_ = 0;
  bool source_is_empty_ = false;
  std::size_t lines_read_ = 0;  // from the source
  std::deque<TextLine> given_back_;
  std::string current_;  // the line that Next() gave last, if it is not in the buffer
  std::size_t number_ = 0;
};

/// Separator between the cells of a line: semicolon, tab, comma or blanks, in this order; blanks
/// before commas where these can only be decimal ones, as in `0,01 1,5`. Texts in quotes do not
/// count.
char SeparatorOf(std::string_view text);

/// The value of a cell: a number, with a decimal comma if the separator is another character; the
/// seconds of a date or clock (see SecondsOfText); NaN for a missing value. None for other texts.
std::optional<double> ValueIn(std::string_view cell, char separator);
/// True if ValueIn() has one.
bool IsValue(std::string_view cell, char separator);

/// The bytes of a source up to its end, or the first `most` of them.
inline std::string BytesOf(const TextLines::Source& source, std::size_t most = SIZE_MAX) {
  constexpr std::size_t kBlock = std::size_t{1} << 16;
  std::string bytes;
  for (std::size_t got = 1; got > 0 && bytes.size() < most;) {
    const std::size_t size = bytes.size();
    bytes.resize(std::min(size + kBlock, most));
    got = source(bytes.data() + size, bytes.size() - size);
    bytes.resize(size + got);
  }
  return bytes;
}

/// The bytes of a text that its format needs whole. Errors: UserError with `name` as its place for
/// more than 512 MB.
inline std::string WholeTextOf(const TextLines::Source& source, const std::string& name) {
  constexpr std::size_t kMost = 512'000'000;
  std::string bytes = BytesOf(source, kMost + 1);
  if (bytes.size() > kMost) {
    throw UserError({.place = name,
                     .problem = "has more than 512 MB, the limit of a text that is read whole; "
                                "cut it into parts"});
  }
  return bytes;
}

/// `head`, then the bytes of `rest`, if there is one.
inline TextLines::Source WithHead(std::string head, TextLines::Source rest) {
  return [head = std::move(head), given = std::size_t{0}, rest = std::move(rest)](
             char* buffer, std::size_t size) mutable {
    if (given == head.size()) return rest ? rest(buffer, size) : 0;
    const std::size_t count = head.copy(buffer, size, given);
    given += count;
    return count;
  };
}

}  // namespace gauntlet::sim
