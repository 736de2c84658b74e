#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <initializer_list>
#include <optional>
#include <shared_mutex>
#include <span>
#include <stdexcept>

#include "sim/base/child_process.h"

namespace gauntlet::sim {

/// What a helper process may use before it is ended.
struct HelperLimits {
  double processor_s = 10.0;
  std::size_t memory_bytes = std::size_t{512} << 20;  // on top of what the program has by then
  int silence_s = 60;                                 // that the program waits for the next bytes
};

/// The helper did not get to its end: it crashed or went beyond its limits. what() says so as the
/// end of a sentence: "ended by signal 11 (Segmentation fault)".
class HelperEnded : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The helper did not get to its end, which is not the file's fault: it used little processor time
/// and sent nothing for as long as the program waits.
class HelperSilent : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The work of the helper threw an exception; what() is its text.
class HelperError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A helper starts as a copy of the program with all locks as they are: of a library that locks
/// itself (HDF5) and that another thread is just inside, it would wait for ever. Who calls such a
/// library in the program holds this meanwhile; helpers start while nobody does.
std::shared_lock<std::shared_mutex> HoldHelpers();

/// Work on what a stranger made, with a library that may crash, hang or take all memory over it: in
/// a process of its own, which has nothing open but the way back, writes no file, gains no rights,
/// and goes when the program goes. It sends bytes; what they say is to be doubted, too.
class HelperProcess {
 public:
  using Send = std::function<void(std::span<const char>)>;

  /// Starts `work`. While the program waits for it, `keep_going` is asked some times per second;
  /// false ends the helper by a Cancelled exception.
  /// Errors: RunError if no process can be started.
  HelperProcess(const std::function<void(const Send&)>& work, const HelperLimits& limits,
                std::function<bool()> keep_going = {});
  /// Ends the helper if it still works.
  ~HelperProcess();
  HelperProcess(const HelperProcess&) = delete;
  HelperProcess& operator=(const HelperProcess&) = delete;

  /// Fills `bytes` with the next that the helper sends. Errors: HelperEnded, also where the helper
  /// has nothing more to send; HelperSilent; HelperError.
  void Receive(std::span<char> bytes);
  /// Waits for the end of the work. Errors: as above, and HelperEnded where bytes are left over.
  void Finish();

 private:
  enum class Frame : char { kBytes, kError, kEnd };
  /// On the pipe before what is sent.
  struct FrameHead {
    Frame frame;
    std::uint32_t size;
  };
  [[noreturn]] static void Work(const std::function<void(const Send&)>& work,
                                const HelperLimits& limits, int pipe);
  static void WriteFrame(int pipe, Frame frame, std::span<const char> bytes);
  /// Reads as much of `bytes` as there is, at least one.
  std::size_t ReadSome(std::span<char> bytes);
  void ReadAll(std::span<char> bytes);
  /// Begins the next frame of bytes; false at the end.
  bool NextFrame();
  [[noreturn]] void ThrowEnded();

  HelperLimits limits_;
  std::function<bool()> keep_going_;
  int pipe_ = -1;
  std::optional<ChildProcess> process_;
  std::size_t left_of_frame_ = 0;
};

/// For the work of a helper that has opened its file: from now on no other can be opened, by
/// whatever name the file has for it.
void OpenNoMoreFiles();

/// The same for files outside these folders.
/// Errors: UserError where the system has no Landlock (Linux before 5.13).
void ReadOnlyBelow(std::initializer_list<std::filesystem::path> folders);

}  // namespace gauntlet::sim
