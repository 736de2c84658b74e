#pragma once

#include <chrono>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "sim/trial/external/command_words.h"
#include "sim/trial/external/supervised_process.h"

namespace gauntlet::sim {

/// A program that answers a line with a line. It ends with this object, and so does all that it has
/// started (see SupervisedProcess).
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

  std::string name_;  // its words
  Descriptor input_;  // of the program
  Descriptor output_;
  Descriptor errors_;
  std::unique_ptr<SupervisedProcess> process_;
  std::string unsent_;
  std::string received_;
  std::string answer_;
  std::string errors_tail_;
};

/// A sentence for each program that left processes behind outside its group since the last call:
/// "python3 f.py started processes that left its process group (sleep); they were ended with it".
std::vector<std::string> TakeLeftProcesses();

}  // namespace gauntlet::sim
