#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "sim/base/child_process.h"
#include "sim/base/descriptor.h"
#include "sim/trial/external/command_words.h"

namespace gauntlet::sim {

/// Processes of a program that had left its process group, and so may not know of its end: their
/// names as the system shows them.
struct LeftGroup {
  std::vector<std::string> ended;    // with the program
  std::vector<std::string> running;  // they have other rights
};

/// A program of the user, as a shell would start it: in a process group of its own, every signal
/// with its default action, no descriptor but its streams.
///
/// A small process between it and this one, its supervisor, ends it and all processes that it has
/// started, also those that left its group, with this object and with this process, however it
/// ends.
class SupervisedProcess {
 public:
  /// `streams`: its standard input, output and error, which stay open here. A program that is not
  /// there ends with exit code 127 and the reason as its only error.
  /// Errors: std::system_error if the system gives no process.
  SupervisedProcess(const ProgramCommand& command, const std::array<int, 3>& streams);
  ~SupervisedProcess() { Kill(); }
  SupervisedProcess(const SupervisedProcess&) = delete;
  SupervisedProcess& operator=(const SupervisedProcess&) = delete;

  /// How the program itself has ended; none while it runs.
  std::optional<ChildEnd> End();
  /// Kills it and all that it has started. Those that left its group have a moment to see that
  /// their input is closed. A second call does nothing.
  LeftGroup Kill();

 private:
  /// Takes the next message of the supervisor; false if there is none.
  bool Receive(int flags);

  Descriptor supervisor_;
  std::optional<ChildEnd> end_;
  LeftGroup left_;
};

/// Ends the process that starts programs, with what it has seen of this one: the environment. The
/// next program gets a new one.
void ForgetSurroundings();

}  // namespace gauntlet::sim
