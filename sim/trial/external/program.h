#pragma once

#include <chrono>
#include <memory>
#include <string>
#include <string_view>

#include "sim/base/child_process.h"
#include "sim/trial/external/command_words.h"

namespace gauntlet::sim {

/// A program that answers a line with a line. It gets no descriptor but its three streams and a
/// process group of its own, ignores the signals that ask the program to stop, and ends with this
/// object or with the thread that made it, whichever is first.
///
/// Neither waits without a limit: both directions and the errors are read and written together, so
/// a program that writes much or reads nothing cannot block the trial.
class Program {
 public:
  using Duration = std::chrono::steady_clock::duration;

  /// Errors: RunError if it cannot be started.
  explicit Program(const ProgramCommand& command);
  /// Closes its input, and kills it if it does not end at once.
  ~Program();
  Program(const Program&) = delete;
  Program& operator=(const Program&) = delete;

  /// Sends text that needs no answer. Errors: as Ask().
  void Tell(std::string_view text, Duration limit);
  /// Sends a line and returns the answer, without its line end; valid until the next call.
  /// Errors: RunError whose text is the end of a sentence ("ended with exit code 1: ValueError"):
  /// the program's end, silence, an answer before the question was read, two answers, an answer
  /// longer than 1 MB. Cancelled when Gauntlet is asked to end.
  std::string_view Ask(std::string_view line, Duration limit);

 private:
  /// One end of a pipe. Closes it.
  class End {
   public:
    explicit End(int descriptor = -1) : descriptor_(descriptor) {}
    ~End() { Close(); }
    End(const End&) = delete;
    End& operator=(const End&) = delete;
    int get() const { return descriptor_; }
    void Set(int descriptor);
    int Release();
    void Close();

   private:
    int descriptor_;
  };
  struct Pipe;

  /// Waits for whatever comes first, at most until `deadline`; takes what there is.
  void Exchange(std::chrono::steady_clock::time_point deadline);
  void ReadErrors();
  /// False at the end of the stream.
  bool ReadAnswers();
  void Send();
  [[noreturn]] void FailAtEnd();
  /// It and the processes that it started.
  void KillAll();
  /// ": " and the last line that it wrote to standard error, if there is one.
  std::string LastWords();

  End input_;  // of the program
  End output_;
  End errors_;
  std::unique_ptr<ChildProcess> child_;
  std::string unsent_;
  std::string received_;
  std::string answer_;
  std::string errors_tail_;
};

}  // namespace gauntlet::sim
