#include "sim/base/shell_word.h"

#include <fmt/format.h>

#include "sim/base/text.h"

namespace gauntlet::sim {
namespace {

/// Characters without a special meaning in any shell.
constexpr std::string_view kPlain =
    "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_./:,+@%-";

/// $'..' with three octal digits per byte that is not printable ASCII; three, because a digit may
/// follow.
std::string InDollarQuotes(std::string_view text) {
  std::string escaped = "$'";
  for (const char c : text) {
    if (c == '\'' || c == '\\') {
      escaped += {'\\', c};
    } else if (c >= ' ' && c <= '~') {
      escaped += c;
    } else {
      escaped += c == '\n' ? "\\n" : fmt::format("\\{:03o}", static_cast<unsigned char>(c));
    }
  }
  return escaped + "'";
}

}  // namespace

std::string ShellWord(std::string_view text) {
  if (!text.empty() && text.find_first_not_of(kPlain) == std::string_view::npos) {
    return std::string(text);
  }
  if (text.find_first_of("\n\t") != std::string_view::npos || !TextProblem(text).empty()) {
    return InDollarQuotes(text);
  }
  std::string quoted = "'";
  for (const char c : text) quoted += c == '\'' ? "'\\''" : std::string(1, c);
  return quoted + "'";
}

std::string ShellPath(const std::filesystem::path& path) {
  const std::string& text = path.native();
  return ShellWord(text.starts_with('-') ? "./" + text : text);
}

}  // namespace gauntlet::sim
