#include "sim/cli/standard_streams.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>

#include "sim/base/error.h"
#include "sim/base/text.h"

namespace gauntlet::sim {
namespace {

int output_error = 0;  // the first one

void NoteUnless(bool written) {
  if (!written && output_error == 0) output_error = errno;
}

}  // namespace

void OpenStandardStreams() {
  // Writing results into a closed stream stays an error: this one can only be read.
  constexpr int kModes[] = {O_RDWR, O_RDONLY, O_RDWR};
  for (int stream = STDIN_FILENO; stream <= STDERR_FILENO; ++stream) {
    // The lowest free descriptor is this one, as those below it are open.
    if (fcntl(stream, F_GETFD) < 0) static_cast<void>(open("/dev/null", kModes[stream]));
  }
}

void SayText(std::string_view text) noexcept {
  while (!text.empty()) {
    const ssize_t written = write(STDERR_FILENO, text.data(), text.size());
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) return;
    text.remove_prefix(static_cast<std::size_t>(written));
  }
}

void SayLine(std::string_view line) {
  if (line.ends_with('\n')) line.remove_suffix(1);
  constexpr std::size_t kLongestShownByte = 4;
  SayText(OneLine(line, kLongestShownByte * line.size()) + "\n");
}

void WarnIfUnchecked(const std::string& folder, bool checked) {
  if (checked) return;
  Say("gauntlet: warning: {} has no manifest.json: its files are not checked\n", folder);
}

void PrintText(std::string_view text) {
  NoteUnless(std::fwrite(text.data(), 1, text.size(), stdout) == text.size());
}

void FlushOutput() { NoteUnless(std::fflush(stdout) == 0); }

void CheckOutput() {
  FlushOutput();
  if (output_error == EPIPE) throw ReaderGone{};
  if (output_error != 0) {
    throw RunError(
        fmt::format("standard output: cannot be written: {}", std::strerror(output_error)));
  }
}

}  // namespace gauntlet::sim
