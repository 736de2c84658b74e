#include "sim/base/output_file.h"

#include <dirent.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <sys/random.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <climits>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <deque>
#include <mutex>
#include <vector>

#include "sim/base/error.h"
#include "sim/base/hash.h"
#include "sim/base/input_file.h"
#include "sim/base/limited_text.h"

namespace gauntlet::sim {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kSuffix = ".part";
constexpr std::string_view kChecksum = "# checksum ";

/// A temporary entry in the list that the signal handler reads.
struct Uncommitted {
  enum State : int { kFree, kBeingSet, kThere };
  std::atomic<int> state = kFree;
  int folder = -1;
  std::array<char, NAME_MAX + 1> name = {};
};

// Fixed memory, because a signal handler may read it at any moment. A program has few files open at
// once. A signal does not remove temporary files beyond the last slot.
constexpr int kPlaces = 64;
std::array<Uncommitted, kPlaces> uncommitted;
std::array<std::atomic<const char*>, kPlaces> new_folders;

int Remember(int folder, const std::string& name) {
  for (int place = 0; place < kPlaces; ++place) {
    Uncommitted& entry = uncommitted[place];
    int expected = Uncommitted::kFree;
    if (!entry.state.compare_exchange_strong(expected, Uncommitted::kBeingSet)) continue;
    entry.folder = folder;
    entry.name = {};
    name.copy(entry.name.data(), entry.name.size() - 1);
    entry.state = Uncommitted::kThere;
    return place;
  }
  return -1;
}

void Forget(int place) {
  if (place >= 0) uncommitted[place].state = Uncommitted::kFree;
}

[[noreturn]] void Fail(std::string_view action, const fs::path& path, int error) {
  throw RunError(fmt::format("{}: cannot {}: {}", path.string(), action, std::strerror(error)));
}

/// Path of an open descriptor, also valid in child processes.
fs::path PathOf(int descriptor) { return fmt::format("/proc/{}/fd/{}", getpid(), descriptor); }

/// Common beginning of the temporary names of a target, short enough for the random part behind it.
std::string PrefixOf(const fs::path& target) {
  constexpr std::size_t kLongest = 180;
  return fmt::format(".{}.", target.filename().string().substr(0, kLongest));
}

std::string RandomName(const fs::path& target) {
  std::uint64_t random = 0;
  if (getrandom(&random, sizeof random, 0) != sizeof random) Fail("write", target, errno);
  return fmt::format("{}{}.{:016x}{}", PrefixOf(target), getpid(), random, kSuffix);
}

/// Removes temporary entries of the same target whose process no longer exists.
void RemoveRemains(int folder, const fs::path& target) {
  const std::string prefix = PrefixOf(target);
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(PathOf(folder), ignored)) {
    const std::string name = entry.path().filename().string();
    if (!name.starts_with(prefix) || !name.ends_with(kSuffix)) continue;
    const int process = std::atoi(name.c_str() + prefix.size());
    if (process > 0 && kill(process, 0) != 0 && errno == ESRCH) {
      fs::remove_all(entry.path(), ignored);
    }
  }
}

int OpenFolder(const fs::path& folder) {
  const fs::path path = folder.empty() ? "." : folder;
  const int readable = open(path.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  return readable >= 0 ? readable : open(path.c_str(), O_PATH | O_DIRECTORY | O_CLOEXEC);
}

/// Safe in a signal handler: system calls only, no heap.
void RemoveEntry(int folder, const char* name) noexcept {
  if (unlinkat(folder, name, 0) == 0) return;
  const int below = openat(folder, name, O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
  if (below < 0) return;
  alignas(dirent64) char entries[4096];
  for (ssize_t size = getdents64(below, entries, sizeof entries); size > 0;
       size = getdents64(below, entries, sizeof entries)) {
    for (ssize_t at = 0; at < size;) {
      const auto* entry = reinterpret_cast<const dirent64*>(entries + at);
      unlinkat(below, entry->d_name, 0);  // the system refuses "." and ".."
      at += entry->d_reclen;
    }
  }
  close(below);
  unlinkat(folder, name, AT_REMOVEDIR);
}

/// True if the file at `target` is a manifest, a study database, or named by a manifest beside it
/// (manifest.h).
bool IsResult(const fs::path& target) {
  constexpr std::string_view kManifest = "manifest.json";
  std::error_code ignored;
  if (!fs::exists(fs::symlink_status(target, ignored))) return false;
  const std::string name = target.filename().string();
  if (name == "study.db" || name.ends_with(kManifest)) return true;
  const fs::path folder = target.has_parent_path() ? target.parent_path() : ".";
  const std::string mark = fmt::format("\"{}\": {{", name);
  return std::ranges::any_of(fs::directory_iterator(folder, ignored), [&](const auto& entry) {
    return entry.path().filename().string().ends_with(kManifest) &&
           entry.is_regular_file(ignored) &&
           LimitedTextIfAny(entry.path(), kMostManifestBytes).value_or("").find(mark) !=
               std::string::npos;
  });
}

void RefuseResult(const fs::path& target) {
  if (!IsResult(target)) return;
  throw UserError({.place = target.string(),
                   .problem = "is a result of another command and is kept; name another file"});
}

/// A device or pipe at the place of a file would be replaced by the file, with root's rights for
/// all programs.
void RefuseSpecial(const fs::path& target) {
  std::error_code error;
  const fs::file_status status = fs::status(target, error);  // behind links
  if (error || !fs::exists(status) || fs::is_regular_file(status) || fs::is_directory(status)) {
    return;
  }
  throw UserError(
      {.place = target.string(), .problem = "is a device or pipe, must be the name of a file"});
}

}  // namespace

TemporaryEntry::TemporaryEntry(const fs::path& target, Kind kind)
    : target_(target), folder_(OpenFolder(target.parent_path())) {
  if (!folder_.is_open()) Fail("write", target_, errno);
  RemoveRemains(folder(), target_);
  int error = EEXIST;
  while (!entry_.is_open() && error == EEXIST) {
    name_ = RandomName(target_);
    place_ = Remember(folder(), name_);
    if (kind == Kind::kFile) {
      entry_.Set(openat(folder(), name_.c_str(), O_RDWR | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC,
                        0666));
    } else if (mkdirat(folder(), name_.c_str(), 0777) == 0) {
      entry_.Set(openat(folder(), name_.c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC));
    }
    error = errno;
    if (!entry_.is_open()) Forget(place_);
  }
  path_ = PathOf(descriptor());
  if (!entry_.is_open()) Fail("write", target_, error);
}

TemporaryEntry::~TemporaryEntry() {
  if (!renamed_) RemoveEntry(folder(), name_.c_str());
  Forget(place_);
}

void TemporaryEntry::Rename() {
  if (fsync(descriptor()) != 0) Fail("write", target_, errno);
  if (renameat(folder(), name_.c_str(), folder(), target_.filename().c_str()) != 0) {
    Fail("write", target_, errno);
  }
  renamed_ = true;
  FlushFolder();
}

void TemporaryEntry::FlushFolder() const { static_cast<void>(fsync(folder())); }

OutputFile::OutputFile(fs::path target) : OutputFile(std::move(target), Replaces::kNoResult) {}

OutputFile::OutputFile(fs::path target, Replaces replaces)
    : target_(std::move(target)), temporary_(target_, TemporaryEntry::Kind::kFile) {
  RefuseSpecial(target_);
  RefuseInput(target_);
  if (replaces == Replaces::kNoResult) RefuseResult(target_);
}

void OutputFile::Write(std::string_view content) {
  while (!content.empty()) {
    const ssize_t written = write(temporary_.descriptor(), content.data(), content.size());
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) Fail("write", target_, errno);
    content.remove_prefix(written);
  }
}

void OutputFile::Commit() {
  RefuseInput(target_);  // more files may have been read meanwhile
  temporary_.Rename();
}

StagingFolder::StagingFolder(const fs::path& folder)
    : folder_(folder), temporary_(folder / "results", TemporaryEntry::Kind::kFolder) {}

void StagingFolder::MoveUp() {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(path())) {
    names.push_back(entry.path().filename().string());
  }
  std::ranges::sort(names);
  for (const std::string& name : names) {
    if (renameat(temporary_.descriptor(), name.c_str(), temporary_.folder(), name.c_str()) != 0) {
      Fail("write", folder_ / name, errno);
    }
  }
  temporary_.FlushFolder();
}

void WriteOutputFile(const fs::path& target, std::string_view content) {
  OutputFile file(target);
  file.Write(content);
  file.Commit();
}

std::string WithChecksum(std::string_view text) {
  Hash hash;
  hash.Add(text);
  return fmt::format("{}{}: without an edit, gauntlet may replace this file\n{}", kChecksum,
                     hash.Text(), text);
}

void RefuseEdited(const fs::path& target) {
  std::error_code ignored;
  if (!fs::exists(fs::symlink_status(target, ignored))) return;
  const std::string text = LimitedTextIfAny(target, kMostEditableBytes).value_or("");
  const std::size_t end = text.find('\n');
  if (end != std::string::npos && WithChecksum(text.substr(end + 1)) == text) return;
  throw UserError({.place = target.string(),
                   .problem = "was edited, or is no file of this command; --force replaces it"});
}

void WriteEditableFile(const fs::path& target, std::string_view text, bool force) {
  if (!force) RefuseEdited(target);
  WriteOutputFile(target, WithChecksum(text));
}

void RefuseInput(const fs::path& target) {
  if (!IsInput(target)) return;
  throw UserError({.place = target.string(),
                   .problem = "is an input of this command, which no output replaces"});
}

void MakeDirectory(const fs::path& directory) {
  std::error_code error;
  fs::create_directories(directory, error);
  if (error) Fail("make the folder", directory, error.value());
}

void MakeDirectoryOf(const fs::path& target) {
  if (target.has_parent_path()) MakeDirectory(target.parent_path());
}

void RemoveIfEmptyLater(const fs::path& folder) {
  static std::mutex mutex;
  static std::deque<std::string> names;  // must outlive the signal handler
  const std::lock_guard lock(mutex);
  const auto place =
      std::ranges::find(new_folders, nullptr, [](const auto& name) { return name.load(); });
  if (place != new_folders.end()) *place = names.emplace_back(folder.string()).c_str();
}

void RemoveUncommittedFiles() noexcept {
  for (Uncommitted& entry : uncommitted) {
    if (entry.state == Uncommitted::kThere) RemoveEntry(entry.folder, entry.name.data());
  }
  for (const std::atomic<const char*>& folder : new_folders) {
    if (const char* name = folder.load(); name != nullptr) rmdir(name);
  }
}

}  // namespace gauntlet::sim
