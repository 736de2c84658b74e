#pragma once

#include <sys/types.h>

#include <functional>
#include <optional>
#include <string>

namespace gauntlet::sim {

/// How a child ended.
struct ChildEnd {
  int signal = 0;     // that ended it; 0: it ended by itself
  int exit_code = 0;  // if it ended by itself
};

/// A copy of this process, as it is when the child is made, for work that may crash. Nothing of the
/// parent is tidied up there: no destructor, no exit handler. The parent hears the signals that ask
/// the program to stop; the child never outlives it.
///
/// Other threads of the parent are not there: the copy of a lock that one of them holds stays
/// closed.
class ChildProcess {
 public:
  /// `work` runs in the child, which ends with exit code 0 when it returns; it throws nothing.
  /// Errors: std::system_error if the system gives no process.
  explicit ChildProcess(const std::function<void()>& work);
  /// Ends the child, wherever it is, and waits for its end.
  ~ChildProcess();
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  void Kill();
  /// Waits for the end. None if the system does not know it any more. To be asked once.
  std::optional<ChildEnd> Wait();

 private:
  pid_t process_ = -1;
};

/// "ended by signal 11 (Segmentation fault)" or "ended with exit code 3".
std::string TextOf(const ChildEnd& end);

}  // namespace gauntlet::sim
