#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace gauntlet::sim {

/// Checks of third-party text, and its printable form.

/// Position of the first byte that is not valid UTF-8; none if all are valid.
std::optional<std::size_t> FirstBadByte(std::string_view text);

/// Width on the screen in characters: continuation bytes of UTF-8 are not counted.
std::size_t Width(std::string_view text);

/// Printable form for a message: one line of at most `longest` bytes. `\n`, `\t` and `\xNN` replace
/// characters that are not printable and bytes that are not UTF-8. `...` replaces the middle of a
/// long text, so that the beginning (file, key) and the end (allowed values) stay.
std::string OneLine(std::string_view text, std::size_t longest = 300);

/// Printable form of a value inside a message, with a shorter limit.
std::string Shown(std::string_view value);

/// True if the text can be a key or a column name: 1 to 40 letters, digits, `_`, `.` and `-`, not
/// beginning with the last two. Messages quote no other text of a file, because the file may be
/// confidential or chosen by mistake.
bool LooksLikeKey(std::string_view text);

/// The error message for a byte that is not UTF-8, or a control character other than line end and
/// tabulator; empty if the text is valid.
std::string TextProblem(std::string_view text);

/// The error message for an invalid name; empty if the name is valid. A name may become a file
/// name: 1 to 60 printable characters, no slash or backslash, no dot at its beginning, no blank at
/// an end.
std::string NameProblem(std::string_view name);

}  // namespace gauntlet::sim
