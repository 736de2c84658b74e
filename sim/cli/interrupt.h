#pragma once

#include <filesystem>
#include <string_view>

namespace gauntlet::sim {

/// Message to the user when a signal ended the program.
constexpr std::string_view kInterrupted = "interrupted; nothing half-written was left";

/// From now on Ctrl-C, SIGTERM, SIGHUP and SIGQUIT ask long work to stop (see sim/base/stop.h).
/// Work that does not hear it within a moment, and all work at a second signal, is ended at once,
/// without leaving temporary files. What was to be ignored when the program began, as below nohup,
/// stays so. A full quota of a file (SIGXFSZ) and a reader that has gone (SIGPIPE) become errors of
/// writing.
void CatchSignals();

/// From now on these signals end the program at once: it waits for a source, and has nothing to
/// tidy.
void EndAtSignals();

/// While it exists, the first signal is a request alone (see StopAsked()), and the second one ends
/// the program at once: motors are brought to rest first. At its end a request is forgotten, for
/// what follows is the answer to it.
class EndsAtSecondSignal {
 public:
  EndsAtSecondSignal();
  ~EndsAtSecondSignal();
  EndsAtSecondSignal(const EndsAtSecondSignal&) = delete;
  EndsAtSecondSignal& operator=(const EndsAtSecondSignal&) = delete;
};

/// A signal that ends the program at once says besides that `file` keeps finished trials. To be
/// called once, before the file is made. Returns `file`.
const std::filesystem::path& KeepsTrials(const std::filesystem::path& file);

/// The signal was heard, and the program has stopped: 128 + the signal, as shells have it.
int ExitCodeOfStop();

}  // namespace gauntlet::sim
