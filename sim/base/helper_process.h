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
#include <string>

#include "sim/base/child_process.h"
#include "sim/base/descriptor.h"

namespace gauntlet::sim {

/// Resources of a helper process. Beyond them it is ended.
struct HelperLimits {
  double processor_s = 10.0;
  std::size_t memory_bytes = std::size_t{512} << 20;  // in addition to the program's own
  int silence_s = 60;  // longest wait for the next bytes while it uses no processor time
};

/// The helper crashed or exceeded its limits. what() is the end of a sentence: "ended by signal 11
/// (Segmentation fault)".
class HelperEnded : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The helper sent nothing within the longest wait and used no processor time. The file is not the
/// cause.
class HelperSilent : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The work of the helper threw an exception; what() is its text.
class HelperError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Prevents the start of helpers while the returned lock is held. A helper is a copy of the program
/// with all locks as they are. If another thread is inside a library with a lock of its own (HDF5),
/// the helper would wait forever. So the program holds this lock during calls of such a library.
std::shared_lock<std::shared_mutex> HoldHelpers();

/// Work on a third-party file, with a library that may crash, hang or use all memory. The work runs
/// in a process of its own. This process has no open descriptor but the pipe to the program, writes
/// no file, gains no rights, and ends with the program. The program must check the bytes that it
/// receives. The destructor ends the helper if it still works.
class HelperProcess {
 public:
  using Send = std::function<void(std::span<const char>)>;

  /// Starts `work`. While the program waits for bytes, it calls `keep_going` several times per
  /// second. False ends the helper, and the program throws Cancelled.
  /// Errors: RunError if no process can be started.
  HelperProcess(const std::function<void(const Send&)>& work, const HelperLimits& limits,
                std::function<bool()> keep_going = {});

  /// Waits for the next bytes from the helper, and returns their number; 0: the work is done.
  /// Errors: HelperEnded, HelperSilent, HelperError.
  std::size_t ReceiveSome(std::span<char> bytes);
  /// Fills `bytes`. Errors: as of ReceiveSome(), and HelperEnded if the work is done before.
  void Receive(std::span<char> bytes);
  /// Waits for the end of the work. Errors: as of Receive(), and HelperEnded if bytes are left
  /// over.
  void Finish();

 private:
  enum class Frame : char { kBytes, kError, kEnd };
  /// Header of a frame on the pipe.
  struct FrameHead {
    Frame frame;
    std::uint32_t size;
  };
  [[noreturn]] static void Work(const std::function<void(const Send&)>& work,
                                const HelperLimits& limits, int pipe);
  static void WriteFrame(int pipe, Frame frame, std::span<const char> bytes);
  /// Reads the bytes that are in the pipe, at least one, at most the size of `bytes`.
  std::size_t ReadSome(std::span<char> bytes);
  /// Waits until the pipe has bytes or its end.
  void WaitForBytes();
  void ReadAll(std::span<char> bytes);
  /// Reads the header of the next frame. False if the work is done.
  bool NextFrame();
  [[noreturn]] void ThrowEnded();

  HelperLimits limits_;
  std::function<bool()> keep_going_;
  Descriptor pipe_;
  std::optional<ChildProcess> process_;
  std::string read_ahead_;    // bytes of the pipe
  std::size_t given_ = 0;     // of these
  double processor_s_ = 0.0;  // of the helper, when it last made progress
  std::size_t left_of_frame_ = 0;
  bool is_done_ = false;
};

/// For a helper whose file is open: forbids the process to open any other file, also one that the
/// file refers to.
void OpenNoMoreFiles();

/// Forbids the process to open files outside these folders.
/// Errors: UserError where the system has no Landlock (Linux before 5.13).
void ReadOnlyBelow(std::initializer_list<std::filesystem::path> folders);

}  // namespace gauntlet::sim
