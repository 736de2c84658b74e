#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>

namespace gauntlet::sim {

/// Memory for the values of one signal. Short signals are on the heap. A long one, or one beyond
/// the total for the heap, is in a file without a name that is mapped into memory. The system loads
/// and drops its pages, so a long trial needs disk space and little memory. The file vanishes with
/// the object, however the program ends.
///
/// The whole disk space is allocated in the constructor: a full disk is an error there, not during
/// a computation. On the disk all bytes are 0 at first; on the heap they are not initialised.
///
/// Errors: RunError with the folder and its free space; std::bad_alloc.
class SignalStorage {
 public:
  SignalStorage() = default;
  explicit SignalStorage(std::size_t bytes);
  ~SignalStorage();
  SignalStorage(SignalStorage&& other) noexcept;
  SignalStorage& operator=(SignalStorage&& other) noexcept;

  void* data() const { return data_; }  // null if empty; else aligned to 64 bytes
  bool is_on_disk() const { return is_on_disk_; }

 private:
  bool FitsOnHeap();
  void MapFile();

  void* data_ = nullptr;
  std::size_t bytes_ = 0;
  std::size_t counted_bytes_ = 0;  // counted against the total for the heap
  bool is_on_disk_ = false;
};

/// Thresholds for signals on the disk.
struct SignalStorageLimits {
  std::size_t counted_from_bytes = std::size_t{1} << 20;  // shorter ones: always on the heap
  std::size_t longest_on_heap_bytes = std::size_t{16} << 20;
  std::size_t all_on_heap_bytes = std::size_t{192} << 20;
  /// Largest total on the disk. Beyond it the disk counts as full.
  std::uintmax_t all_on_disk_bytes = UINTMAX_MAX;
  /// Resident bytes of mapped files (the program's own included) from which TrimSignals() acts.
  std::size_t resident_bytes = std::size_t{160} << 20;
};
/// To be called at the start of a program or in tests, while no other thread makes signals.
void SetSignalStorageLimits(const SignalStorageLimits& limits);
const SignalStorageLimits& GetSignalStorageLimits();

/// Puts later signals on the disk of this folder, or of the nearest existing folder above it. If it
/// accepts no file, TMPDIR or /var/tmp is used, as before the first call.
void SetSignalFolder(const std::filesystem::path& folder);

/// The folder for signals, and its free space.
struct SignalSpace {
  std::filesystem::path folder;
  std::uintmax_t free_bytes = 0;
};
SignalSpace FreeSignalSpace();

/// Releases the memory of signals on the disk if they use much of it. The values stay, and the
/// system loads them again when needed. Loops over long signals call it every few megabytes, from
/// any thread; without long signals it costs almost nothing.
void TrimSignals();
/// Releases it however little they use: for a program that shall not grow while it runs.
void ReleaseSignals();

}  // namespace gauntlet::sim
