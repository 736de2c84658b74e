#pragma once

#include <sys/types.h>

#include <functional>
#include <optional>
#include <string>

namespace gauntlet::sim {

/// The way in which a child ended.
struct ChildEnd {
  int signal = 0;     // signal that ended it; 0: none
  int exit_code = 0;  // only without a signal
};

/// A child process for work that may crash: a copy (fork) of this process. The child runs no
/// destructors and no exit handlers of the parent. It ignores the signals that ask the program to
/// stop, and it ends when the parent ends.
///
/// Other threads of the parent do not exist in the child. A lock that one of them holds stays
/// locked there.
class ChildProcess {
 public:
  /// `work` runs in the child, which ends with exit code 0 when it returns; it throws nothing.
  /// Errors: std::system_error if the system gives no process.
  explicit ChildProcess(const std::function<void()>& work);
  /// Kills the child if it still runs, and waits for its end.
  ~ChildProcess();
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  void Kill();
  /// The number of the process until Wait() has returned; then -1.
  pid_t id() const { return process_; }
  /// True if Wait() would return at once.
  bool HasEnded() const;
  /// Waits for the end of the child. None if the system no longer knows the child, and in a second
  /// call.
  std::optional<ChildEnd> Wait();

 private:
  pid_t process_ = -1;
};

/// "ended by signal 11 (Segmentation fault)" or "ended with exit code 3".
std::string TextOf(const ChildEnd& end);

}  // namespace gauntlet::sim
