#pragma once

#include <sys/types.h>

#include <chrono>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace gauntlet::test {

struct ProgramOptions {
  std::string standard_input = {};
  std::map<std::string, std::string> environment = {};  // on top of the inherited one
  bool inherit_environment = true;
  std::filesystem::path working_directory = {};  // empty: the test's own
  std::chrono::milliseconds timeout = std::chrono::seconds(60);
  /// Standard input and standard error are a terminal: input is typed there, and standard error is
  /// what it shows. Its end is typed as Ctrl-D.
  bool on_terminal = false;
};

struct ProgramResult {
  int exit_code = -1;  // -1: ended by a signal
  int signal = 0;      // 0: ended by itself
  bool timed_out = false;
  long peak_memory_kib = 0;  // of the largest of it and its own programs
  std::string standard_output;
  std::string standard_error;
};

/// A running program, in its own process group so that nothing it started outlives the test.
/// At its timeout the whole group is killed.
///
/// Errors: std::system_error if it cannot be started.
class Program {
 public:
  /// `command`: the program (found along PATH if it has no slash) and its arguments.
  explicit Program(const std::vector<std::string>& command, ProgramOptions options = {});
  ~Program();
  Program(const Program&) = delete;
  Program& operator=(const Program&) = delete;

  /// Waits until the program has printed `text` to standard output or standard error.
  /// False if it ended, or ran out of time, without having done so.
  bool WaitForText(std::string_view text);
  /// Waits until `path` exists; false as above.
  bool WaitForPath(const std::filesystem::path& path);
  /// Waits until the program handles `signal` itself; false as above.
  bool WaitForHandlerOf(int signal);
  void SendSignal(int signal);
  /// More input, at a terminal.
  void Type(std::string_view text);
  /// Waits for its end. The second call gives the same again.
  const ProgramResult& Wait();

 private:
  /// Moves what the pipes have to offer; returns false once the program has ended.
  bool Advance();
  void WriteInput();
  void ReadOutput();

  ProgramOptions options_;
  ProgramResult result_;
  std::size_t input_written_ = 0;
  int input_ = -1;
  int output_ = -1;
  int error_ = -1;
  pid_t process_ = -1;
  bool ended_ = false;
  std::chrono::steady_clock::time_point deadline_;
};

/// Runs a program to its end.
ProgramResult RunProgram(const std::vector<std::string>& command,
                         const ProgramOptions& options = {});

/// A fresh directory that goes away, with its content, at the end of the scope.
class TemporaryDirectory {
 public:
  TemporaryDirectory();
  ~TemporaryDirectory();
  TemporaryDirectory(const TemporaryDirectory&) = delete;
  TemporaryDirectory& operator=(const TemporaryDirectory&) = delete;

  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace gauntlet::test
