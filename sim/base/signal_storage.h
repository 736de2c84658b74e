#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>

namespace gauntlet::sim {

/// Memory for the values of one signal. Short signals lie on the heap. A long one, or one too many,
/// lies in a file without a name that is mapped into memory: its pages come and go, so a long trial
/// needs disk and not memory. The file is gone with the object, however the program ends.
///
/// All of its space is there from the start: a full disk is an error here and not in the middle of
/// a computation. On the disk all bytes are 0 at first, on the heap they are not set.
///
/// Errors: RunError with the folder and its free space; std::bad_alloc.
class SignalStorage {
 public:
  SignalStorage() = default;
  explicit SignalStorage(std::size_t bytes);
  ~SignalStorage();
  SignalStorage(SignalStorage&& other) noexcept;
  SignalStorage& operator=(SignalStorage&& other) noexcept;

  void* data() const { return data_; }  // null for no bytes; else at a multiple of 64
  bool is_on_disk() const { return is_on_disk_; }

 private:
  bool FitsOnHeap();
  void MapFile();

  void* data_ = nullptr;
  std::size_t bytes_ = 0;
  std::size_t counted_bytes_ = 0;  // of the heap's share
  bool is_on_disk_ = false;
};

/// Where signals go to the disk, and when.
struct SignalStorageLimits {
  std::size_t counted_from_bytes = std::size_t{1} << 20;  // shorter ones are always on the heap
  std::size_t longest_on_heap_bytes = std::size_t{16} << 20;
  std::size_t all_on_heap_bytes = std::size_t{192} << 20;
  /// Beyond this the disk counts as full.
  std::uintmax_t all_on_disk_bytes = UINTMAX_MAX;
  /// Of files in memory (the program's own, too), before TrimSignals() does something.
  std::size_t resident_bytes = std::size_t{160} << 20;
};
/// For the start of a program, and tests; not while another thread makes signals.
void SetSignalStorageLimits(const SignalStorageLimits& limits);
const SignalStorageLimits& GetSignalStorageLimits();

/// From now on signals lie on the disk of this folder, or of the nearest one above it that is
/// there; if it takes no file, in TMPDIR or /var/tmp, as before the first call.
void SetSignalFolder(const std::filesystem::path& folder);

/// The folder that signals go to, and how much still fits there.
struct SignalSpace {
  std::filesystem::path folder;
  std::uintmax_t free_bytes = 0;
};
SignalSpace FreeSignalSpace();

/// Takes signals on the disk out of memory if they have come to use much of it; nothing is lost,
/// and what is touched again comes back. Whoever walks through long signals calls it every few
/// megabytes, on any thread; it costs next to nothing while all signals are short. As this is where
/// long work passes again and again, it is also where it ends when it is asked to.
/// Errors: Cancelled.
void TrimSignals();

}  // namespace gauntlet::sim
