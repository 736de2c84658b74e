#include "sim/base/atomic_file.h"

#include <dirent.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <vector>

#include "sim/base/error.h"

namespace gauntlet::sim {
namespace {

constexpr std::string_view kSuffix = ".part";

// Fixed places, because a signal handler may read them at any moment. A program has few files open
// at once; a file beyond the last place is only not removed by a signal.
constexpr int kPlaces = 64;
std::atomic<char*> uncommitted[kPlaces];

void Remember(const std::filesystem::path& path) {
  char* copy = strdup(path.c_str());
  for (auto& place : uncommitted) {
    char* expected = nullptr;
    if (place.compare_exchange_strong(expected, copy)) return;
  }
  free(copy);
}

void Forget(const std::filesystem::path& path) {
  for (auto& place : uncommitted) {
    char* name = place.load();
    if (name != nullptr && path == name && place.compare_exchange_strong(name, nullptr)) {
      free(name);
      return;
    }
  }
}

std::filesystem::path TemporaryPath(const std::filesystem::path& target) {
  return target.parent_path() /
         fmt::format(".{}.{}{}", target.filename().string(), getpid(), kSuffix);
}

/// What a killed program was writing at the same target: its process is no more.
void RemoveRemains(const std::filesystem::path& target) {
  const std::string prefix = fmt::format(".{}.", target.filename().string());
  std::error_code ignored;
  const auto folder = target.has_parent_path() ? target.parent_path() : ".";
  for (const auto& entry : std::filesystem::directory_iterator(folder, ignored)) {
    const std::string name = entry.path().filename().string();
    if (!name.starts_with(prefix) || !name.ends_with(kSuffix)) continue;
    const int process = std::atoi(name.c_str() + prefix.size());
    if (process > 0 && kill(process, 0) != 0 && errno == ESRCH) {
      std::filesystem::remove_all(entry.path(), ignored);
    }
  }
}

[[noreturn]] void Fail(std::string_view action, const std::filesystem::path& path, int error) {
  throw RunError(fmt::format("{}: cannot {}: {}", path.string(), action, std::strerror(error)));
}

/// What a rename changed is on the disk only when the folder is. Where a file system cannot do
/// that, it is not asked for.
void FlushFolder(const std::filesystem::path& folder) {
  const int descriptor =
      open(folder.empty() ? "." : folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) return;
  static_cast<void>(fsync(descriptor));
  close(descriptor);
}

/// For a signal handler: system calls only, no memory from the heap.
void RemoveFolder(const char* path) noexcept {
  const int folder = open(path, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (folder < 0) return;
  alignas(dirent64) char entries[4096];
  for (ssize_t size = getdents64(folder, entries, sizeof entries); size > 0;
       size = getdents64(folder, entries, sizeof entries)) {
    for (ssize_t at = 0; at < size;) {
      const auto* entry = reinterpret_cast<const dirent64*>(entries + at);
      unlinkat(folder, entry->d_name, 0);  // "." and ".." are refused
      at += entry->d_reclen;
    }
  }
  close(folder);
  rmdir(path);
}

}  // namespace

AtomicFile::AtomicFile(std::filesystem::path target) : target_(std::move(target)) {
  temporary_ = TemporaryPath(target_);
  RemoveRemains(target_);
  Remember(temporary_);
}

AtomicFile::~AtomicFile() {
  if (committed_) return;
  unlink(temporary_.c_str());
  Forget(temporary_);
}

void AtomicFile::Commit() {
  const int file = open(temporary_.c_str(), O_RDONLY | O_CLOEXEC);
  if (file < 0) Fail("write", target_, errno);
  const int synced = fsync(file);
  const int error = errno;
  close(file);
  if (synced != 0) Fail("write", target_, error);
  if (rename(temporary_.c_str(), target_.c_str()) != 0) Fail("write", target_, errno);
  committed_ = true;
  Forget(temporary_);
  FlushFolder(target_.parent_path());
}

StagingFolder::StagingFolder(const std::filesystem::path& target) : path_(TemporaryPath(target)) {
  RemoveRemains(target);
  Remember(path_);
  try {
    MakeDirectory(path_);
  } catch (...) {
    Forget(path_);
    throw;
  }
}

StagingFolder::~StagingFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
  Forget(path_);
}

void StagingFolder::MoveTo(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(path_)) files.push_back(entry);
  std::ranges::sort(files);
  for (const std::filesystem::path& file : files) {
    const std::filesystem::path target = folder / file.filename();
    if (rename(file.c_str(), target.c_str()) != 0) Fail("write", target, errno);
  }
  FlushFolder(folder);
}

void AtomicFile::Write(std::string_view content) {
  const int descriptor = open(temporary_.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  if (descriptor < 0) Fail("write", target_, errno);
  while (!content.empty()) {
    const ssize_t written = write(descriptor, content.data(), content.size());
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) {
      const int error = errno;
      close(descriptor);
      Fail("write", target_, error);
    }
    content.remove_prefix(written);
  }
  if (close(descriptor) != 0) Fail("write", target_, errno);
}

void WriteFileAtomically(const std::filesystem::path& target, std::string_view content) {
  AtomicFile file(target);
  file.Write(content);
  file.Commit();
}

void MakeDirectory(const std::filesystem::path& directory) {
  std::error_code error;
  std::filesystem::create_directories(directory, error);
  if (error) Fail("make the folder", directory, error.value());
}

void RemoveIfEmptyLater(const std::filesystem::path& folder) { Remember(folder / ""); }

void RemoveUncommittedFiles() noexcept {
  // A name that ends in a slash is a folder that may only go when it is empty.
  const auto is_folder = [](const char* name) { return name[std::strlen(name) - 1] == '/'; };
  for (auto& place : uncommitted) {
    const char* name = place.load();
    if (name != nullptr && !is_folder(name) && unlink(name) != 0) RemoveFolder(name);
  }
  for (auto& place : uncommitted) {
    const char* name = place.load();
    if (name != nullptr && is_folder(name)) rmdir(name);
  }
}

}  // namespace gauntlet::sim
