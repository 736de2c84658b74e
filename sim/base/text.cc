#include "sim/base/text.h"

#include <fmt/format.h>
#include <utf8.h>

#include <algorithm>
#include <cstdint>
#include <vector>

namespace gauntlet::sim {
namespace {

constexpr std::size_t kLongestName = 60;  // characters: at most 240 bytes, file names may have 255
constexpr std::size_t kLongestValue = 60;

struct Character {
  std::uint32_t code = 0;
  std::size_t size = 0;  // bytes; 0: not UTF-8
};

/// The first character of a text that is not empty.
Character FirstCharacter(std::string_view text) {
  const char* end = text.data();
  try {
    const std::uint32_t code = utf8::next(end, text.data() + text.size());
    return {code, static_cast<std::size_t>(end - text.data())};
  } catch (const utf8::exception&) {
    return {};
  }
}

/// False for control characters, line and paragraph separators, and characters that change the text
/// direction.
bool IsPrintable(std::uint32_t code) {
  const bool control = code < 0x20 || (code >= 0x7f && code < 0xa0);
  const bool line = code == 0x2028 || code == 0x2029;
  const bool direction = (code >= 0x202a && code <= 0x202e) || (code >= 0x2066 && code <= 0x2069);
  return !control && !line && !direction && code != 0xfeff;
}

std::string Escaped(std::string_view bytes) {
  if (bytes == "\n") return "\\n";
  if (bytes == "\t") return "\\t";
  std::string escaped;
  for (const char byte : bytes)
    escaped += fmt::format("\\x{:02x}", static_cast<unsigned char>(byte));
  return escaped;
}

/// Removes the first character from `text` and returns its printable form. Bytes that are not UTF-8
/// are taken one by one.
std::string TakeShown(std::string_view& text) {
  const Character character = FirstCharacter(text);
  const std::string_view bytes = text.substr(0, character.size == 0 ? 1 : character.size);
  text.remove_prefix(bytes.size());
  const bool as_it_is = character.size > 0 && IsPrintable(character.code);
  return as_it_is ? std::string(bytes) : Escaped(bytes);
}

}  // namespace

std::optional<std::size_t> FirstBadByte(std::string_view text) {
  const std::size_t place = utf8::find_invalid(text.begin(), text.end()) - text.begin();
  return place == text.size() ? std::nullopt : std::optional(place);
}

std::size_t Width(std::string_view text) {
  return static_cast<std::size_t>(std::ranges::count_if(
      text, [](char c) { return (static_cast<unsigned char>(c) & 0xc0U) != 0x80; }));
}

std::string OneLine(std::string_view text, std::size_t longest) {
  // A character has at least one byte, and a byte is shown with at most four characters. So only
  // the two ends of a long text matter. A character that is cut there is never shown.
  if (text.size() > 8 * longest) {
    return OneLine(std::string(text.substr(0, 4 * longest)) + ' ' +
                       std::string(text.substr(text.size() - 4 * longest + 1)),
                   longest);
  }
  std::vector<std::string> shown;
  std::size_t size = 0;
  while (!text.empty()) size += shown.emplace_back(TakeShown(text)).size();
  std::size_t begin = shown.size();  // of the part left out
  std::size_t end = shown.size();
  std::string_view middle;
  if (size > longest) {
    middle = "...";
    const std::size_t head = (longest - middle.size()) * 2 / 5;
    const std::size_t tail = longest - middle.size() - head;
    begin = 0;
    for (size = 0; size + shown[begin].size() <= head; ++begin) size += shown[begin].size();
    for (size = 0; size + shown[end - 1].size() <= tail; --end) size += shown[end - 1].size();
  }
  std::string line;
  for (std::size_t i = 0; i < begin; ++i) line += shown[i];
  line += middle;
  for (std::size_t i = end; i < shown.size(); ++i) line += shown[i];
  return line;
}

std::string Shown(std::string_view value) { return OneLine(value, kLongestValue); }

bool LooksLikeKey(std::string_view text) {
  constexpr std::size_t kLongestKey = 40;
  constexpr std::string_view kLetters =
      "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_.-";
  return !text.empty() && text.size() <= kLongestKey && text[0] != '.' && text[0] != '-' &&
         text.find_first_not_of(kLetters) == std::string_view::npos;
}

std::string TextProblem(std::string_view text) {
  while (!text.empty()) {
    const Character character = FirstCharacter(text);
    if (character.size == 0) {
      return fmt::format("has the byte {}, which is not UTF-8", Escaped(text.substr(0, 1)));
    }
    const bool blank = character.code == '\n' || character.code == '\t';
    if (!blank && !IsPrintable(character.code)) {
      return fmt::format("has the control character {}", Escaped(text.substr(0, character.size)));
    }
    text.remove_prefix(character.size);
  }
  return "";
}

std::string NameProblem(std::string_view name) {
  if (name.empty()) return "is empty, must be a name";
  if (std::string problem = TextProblem(name); !problem.empty()) return problem;
  if (Width(name) > kLongestName) {
    return fmt::format("has {} characters, a name has at most {}", Width(name), kLongestName);
  }
  if (name.find_first_of("/\\\n\t") != std::string_view::npos) {
    return "has a slash, a backslash, a tabulator or an end of a line, which no name has";
  }
  if (name.front() == '.') return "begins with a dot, which no name does";
  if (name.front() == ' ' || name.back() == ' ') return "has a blank at an end, which no name has";
  return "";
}

}  // namespace gauntlet::sim
