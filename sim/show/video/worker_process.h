#pragma once

#include <functional>
#include <optional>
#include <string>

#include "sim/base/child_process.h"

namespace gauntlet::sim {

/// Work in a child of this process, which is told by numbers what to do and answers by numbers.
///
/// A library that crashes there, or that has no memory left, ends the work and not the program; one
/// that cannot bear two threads has a process of its own. The child has the standard streams and no
/// other open file. To be made while no other thread runs: see ChildProcess.
class WorkerProcess {
 public:
  /// The child's end.
  class Tasks {
   public:
    explicit Tasks(int socket) : socket_(socket) {}
    /// The next number that was sent; none when there are no more.
    std::optional<int> Next();
    void Answer(int number);

   private:
    int socket_;
  };

  /// `does` completes "the process that .." in messages. `work` runs in the child.
  /// Errors: RunError if the system gives no process.
  WorkerProcess(std::string does, const std::function<void(Tasks&)>& work);
  /// Ends the child, wherever it is, and waits for its end.
  ~WorkerProcess();
  WorkerProcess(const WorkerProcess&) = delete;
  WorkerProcess& operator=(const WorkerProcess&) = delete;

  void Send(int number);
  /// There will be no more numbers.
  void Close();
  /// The next answer; none when the work is done. Errors: UserError and RunError as the work threw
  /// them; RunError that says how the child ended, if it did so before its work was done.
  std::optional<int> Receive();
  /// For poll(): can be read when Receive() would not wait.
  int descriptor() const { return socket_; }

 private:
  std::string does_;
  int socket_ = -1;
  std::optional<ChildProcess> process_;
};

}  // namespace gauntlet::sim
