#pragma once

#include <fmt/format.h>

#include <string_view>
#include <utility>

namespace gauntlet::sim {

/// Whoever read standard output has gone, as `head` does: no error, but an end.
struct ReaderGone {};

/// First of all: where a standard stream is closed, a file that is opened later would become it and
/// get what is meant for the terminal.
void OpenStandardStreams();

/// To standard error, as it is. Where nobody can read it, nothing can be done: it never fails.
void SayText(std::string_view text) noexcept;
/// What a person is told, on standard error: a line, in which no path changes the terminal or makes
/// another line, as OneLine() shows it.
void SayLine(std::string_view line);
template <class... Arguments>
void Say(fmt::format_string<Arguments...> format, Arguments&&... arguments) {
  SayLine(fmt::format(format, std::forward<Arguments>(arguments)...));
}

/// Results, on standard output. CheckOutput() tells if they did not get there.
void PrintText(std::string_view text);
template <class... Arguments>
void Print(fmt::format_string<Arguments...> format, Arguments&&... arguments) {
  PrintText(fmt::format(format, std::forward<Arguments>(arguments)...));
}

/// Hands over what was printed. Does not fail: CheckOutput() tells.
void FlushOutput();
/// The same. Errors: RunError if anything printed so far did not get there; ReaderGone.
void CheckOutput();

}  // namespace gauntlet::sim
