#pragma once

#include <fmt/format.h>

#include <string>
#include <string_view>
#include <utility>

namespace gauntlet::sim {

/// The reader of standard output has gone, as `head` does: no error, but an end.
struct ReaderGone {};

/// First of all: where a standard stream is closed, a file that is opened later would become it and
/// get what is meant for the terminal.
void OpenStandardStreams();

/// Writes to standard error, as it is. Never fails: without a reader nothing can be done.
void SayText(std::string_view text) noexcept;
/// A line for a person, on standard error, as OneLine() shows it: no path in it changes the
/// terminal or makes another line.
void SayLine(std::string_view line);
template <class... Arguments>
void Say(fmt::format_string<Arguments...> format, Arguments&&... arguments) {
  SayLine(fmt::format(format, std::forward<Arguments>(arguments)...));
}

/// Tells that an output folder has no manifest, so that its files are not checked.
void WarnIfUnchecked(const std::string& folder, bool checked);

/// Results, on standard output. CheckOutput() tells if they did not get there.
void PrintText(std::string_view text);
template <class... Arguments>
void Print(fmt::format_string<Arguments...> format, Arguments&&... arguments) {
  PrintText(fmt::format(format, std::forward<Arguments>(arguments)...));
}

/// Hands over what was printed. Does not fail: CheckOutput() tells.
void FlushOutput();
/// FlushOutput() with errors: RunError if anything printed so far did not get there; ReaderGone.
void CheckOutput();

}  // namespace gauntlet::sim
