#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace gauntlet::sim {

/// What text may hold that others wrote, and how it is shown to a person.

/// Where the first byte stands that is not part of a character of UTF-8; none if there is no such.
std::optional<std::size_t> FirstBadByte(std::string_view text);

/// Characters on the screen: continuation bytes of UTF-8 take no place.
std::size_t Width(std::string_view text);

/// As it may stand in a message: on one line, with `\n`, `\t` and `\xNN` for what is not printable
/// or not UTF-8, and no longer than `longest` bytes: `...` stands for what is left out in the
/// middle, so that the beginning (a file, a key) and the end (what is allowed) stay.
std::string OneLine(std::string_view text, std::size_t longest = 300);

/// The same for a value in a message, which is to leave place for the rest.
std::string Shown(std::string_view value);

/// True for a text that can be a key or the name of a column: 1 to 40 letters, digits, `_`, `.` and
/// `-`; the last two do not begin it. Messages repeat no other text of a file: the file may not be
/// meant for Gauntlet, and may be confidential.
bool LooksLikeKey(std::string_view text);

/// The sentence for a text that has a byte that is not UTF-8, or a control character besides the
/// end of a line and the tabulator; empty if it may be used.
std::string TextProblem(std::string_view text);

/// The sentence for what cannot be a name; empty if it can. A name can be that of a file: it has 1
/// to 60 printable characters, no slash nor backslash, no dot at its beginning and no blank at an
/// end.
std::string NameProblem(std::string_view name);

}  // namespace gauntlet::sim
