#include "sim/base/signal_storage.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <malloc.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <map>
#include <mutex>
#include <new>
#include <string>
#include <utility>
#include <vector>

#include "sim/base/error.h"
#include "sim/base/few_signals_on_heap.h"

namespace gauntlet::sim {
namespace {

namespace fs = std::filesystem;

constexpr std::align_val_t kAlignment{64};

SignalStorageLimits limits;
std::atomic<int> wishes_for_few{0};         // objects of FewSignalsOnHeap
std::atomic<std::size_t> bytes_on_heap{0};  // of those that count
std::atomic<std::size_t> bytes_on_disk{0};

/// As many of these bytes as are left where few are wanted.
std::size_t AtMost(std::size_t bytes, std::size_t few_mb) {
  const bool few = wishes_for_few.load(std::memory_order_relaxed) > 0;
  return few ? std::min(bytes, few_mb << 20) : bytes;
}
std::size_t LongestOnHeap() { return AtMost(limits.longest_on_heap_bytes, 4); }
std::size_t AllOnHeap() { return AtMost(limits.all_on_heap_bytes, 64); }
std::size_t MostResident() { return AtMost(limits.resident_bytes, 96); }

/// The existing mappings, and the folder for the next one.
struct Mappings {
  std::mutex mutex;
  std::map<void*, std::size_t> bytes;
  fs::path folder;
};
Mappings& TheMappings() {
  static Mappings mappings;
  return mappings;
}

/// Folders to try, the best first.
std::vector<fs::path> Folders() {
  std::vector<fs::path> folders;
  {
    const std::lock_guard lock(TheMappings().mutex);
    if (!TheMappings().folder.empty()) folders.push_back(TheMappings().folder);
  }
  if (const char* temporary = std::getenv("TMPDIR"); temporary != nullptr && *temporary != '\0') {
    folders.emplace_back(temporary);
  }
  folders.emplace_back("/var/tmp");
  return folders;
}

/// Opens a new file without a name; below 0 if the folder does not support it.
int OpenNamelessFile(const fs::path& folder) {
  const int file = open(folder.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, 0600);
  if (file >= 0) return file;
  std::string name = (folder / ".gauntlet.signal.XXXXXX").string();
  const int named = mkostemp(name.data(), O_CLOEXEC);
  if (named >= 0) unlink(name.c_str());
  return named;
}

std::uintmax_t FreeBytes(const fs::path& folder) {
  std::error_code error;
  const fs::space_info space = fs::space(folder, error);
  const std::uintmax_t used = bytes_on_disk;
  const std::uintmax_t allowed = std::max(limits.all_on_disk_bytes, used) - used;
  return error ? 0 : std::min(space.available, allowed);
}

/// Resident bytes of mapped files: the third number of /proc/self/statm, in pages. The largest
/// value if the system does not report it.
std::size_t ResidentFileBytes() {
  char text[128] = {};
  const int file = open("/proc/self/statm", O_RDONLY | O_CLOEXEC);
  const ssize_t length = file < 0 ? -1 : read(file, text, sizeof(text) - 1);
  if (file >= 0) close(file);
  std::size_t pages = 0;
  if (length <= 0 || std::sscanf(text, "%*s %*s %zu", &pages) != 1) return SIZE_MAX;
  static const auto kPageBytes = static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
  return pages * kPageBytes;
}

/// Allocates all pages of a long signal at once. One page at a time takes twice as long.
void AllocatePages(void* data, std::size_t bytes) {
  static const auto kPageBytes = static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
  const std::size_t into_page = reinterpret_cast<std::uintptr_t>(data) % kPageBytes;
  void* const begin = static_cast<std::byte*>(data) - into_page;
  madvise(begin, into_page + bytes, MADV_POPULATE_WRITE);  // older systems ignore this
}

}  // namespace

SignalStorage::SignalStorage(std::size_t bytes) : bytes_(bytes) {
  if (bytes == 0) return;
  if (FitsOnHeap()) {
    data_ = ::operator new(bytes, kAlignment, std::nothrow);
    if (data_ != nullptr) {
      if (counted_bytes_ > 0) AllocatePages(data_, bytes);
      return;
    }
    bytes_on_heap -= std::exchange(counted_bytes_, 0);
    throw std::bad_alloc();
  }
  MapFile();
}

bool SignalStorage::FitsOnHeap() {
  if (bytes_ < limits.counted_from_bytes) return true;
  if (bytes_ > LongestOnHeap()) return false;
  counted_bytes_ = bytes_;
  if (bytes_on_heap.fetch_add(bytes_) + bytes_ <= AllOnHeap()) return true;
  bytes_on_heap -= std::exchange(counted_bytes_, 0);
  return false;
}

void SignalStorage::MapFile() {
  TrimSignals();
  fs::path folder;
  int file = -1;
  for (const fs::path& candidate : Folders()) {
    folder = candidate;
    file = OpenNamelessFile(folder);
    if (file >= 0) break;
  }
  int error = file < 0 ? errno : 0;
  if (error == 0 && bytes_ > FreeBytes(folder)) error = ENOSPC;
  while (error == 0 && (error = posix_fallocate(file, 0, static_cast<off_t>(bytes_))) == EINTR) {
    error = 0;
  }
  void* place = MAP_FAILED;
  if (error == 0) {
    place = mmap(nullptr, bytes_, PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
    if (place == MAP_FAILED) error = errno;
  }
  if (file >= 0) close(file);
  if (place == MAP_FAILED) {
    throw RunError(fmt::format(
        "{}: cannot keep a signal of {:.1f} MB there, {:.1f} MB are free: {}; a shorter "
        "glove.motion.duration_s needs less",
        folder.string(), 1e-6 * static_cast<double>(bytes_),
        1e-6 * static_cast<double>(FreeBytes(folder)), std::strerror(error)));
  }
  {
    const std::lock_guard lock(TheMappings().mutex);
    TheMappings().bytes.emplace(place, bytes_);
  }
  data_ = place;
  is_on_disk_ = true;
  bytes_on_disk += bytes_;
}

SignalStorage::~SignalStorage() {
  if (data_ == nullptr) return;
  if (is_on_disk_) {
    const std::lock_guard lock(TheMappings().mutex);
    TheMappings().bytes.erase(data_);
    munmap(data_, bytes_);
    bytes_on_disk -= bytes_;
    return;
  }
  ::operator delete(data_, kAlignment);
  bytes_on_heap -= counted_bytes_;
}

SignalStorage::SignalStorage(SignalStorage&& other) noexcept
    : data_(std::exchange(other.data_, nullptr)),
      bytes_(std::exchange(other.bytes_, 0)),
      counted_bytes_(std::exchange(other.counted_bytes_, 0)),
      is_on_disk_(std::exchange(other.is_on_disk_, false)) {}

SignalStorage& SignalStorage::operator=(SignalStorage&& other) noexcept {
  SignalStorage old(std::move(*this));
  data_ = std::exchange(other.data_, nullptr);
  bytes_ = std::exchange(other.bytes_, 0);
  counted_bytes_ = std::exchange(other.counted_bytes_, 0);
  is_on_disk_ = std::exchange(other.is_on_disk_, false);
  return *this;
}

void SetSignalStorageLimits(const SignalStorageLimits& wanted) { limits = wanted; }

const SignalStorageLimits& GetSignalStorageLimits() { return limits; }

FewSignalsOnHeap::FewSignalsOnHeap() { ++wishes_for_few; }
FewSignalsOnHeap::~FewSignalsOnHeap() { --wishes_for_few; }

void ReturnFreedMemory() {
  if (wishes_for_few > 0) malloc_trim(0);
}

void SetSignalFolder(const fs::path& folder) {
  std::error_code ignored;
  fs::path there = fs::absolute(folder, ignored).lexically_normal();
  while (there.has_relative_path() && !fs::is_directory(there, ignored)) {
    there = there.parent_path();
  }
  const std::lock_guard lock(TheMappings().mutex);
  TheMappings().folder = std::move(there);
}

SignalSpace FreeSignalSpace() {
  for (const fs::path& folder : Folders()) {
    if (access(folder.c_str(), W_OK | X_OK) == 0) return {folder, FreeBytes(folder)};
  }
  return {Folders().back(), 0};
}

void TrimSignals() {
  const std::size_t most = MostResident();
  // Too few bytes to exceed the limit.
  if (bytes_on_disk.load(std::memory_order_relaxed) <= most / 2) return;
  if (ResidentFileBytes() <= most) return;
  ReleaseSignals();
}

void ReleaseSignals() {
  const std::lock_guard lock(TheMappings().mutex);
  // For a shared mapping of a file, this releases the pages and keeps the content.
  for (const auto& [place, bytes] : TheMappings().bytes) madvise(place, bytes, MADV_DONTNEED);
}

}  // namespace gauntlet::sim
