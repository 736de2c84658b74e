#include "sim/base/input_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <mutex>
#include <set>
#include <string>
#include <utility>

#include "sim/base/data_folder.h"
#include "sim/base/error.h"

namespace gauntlet::sim {
namespace {

namespace fs = std::filesystem;

/// Device, inode and, where the file system has it, generation of the inode. Empty without a file.
std::string IdentityOf(const fs::path& file) {
  struct stat status = {};
  if (stat(file.c_str(), &status) != 0) return "";
  std::string identity = fmt::format("{}:{}:", status.st_dev, status.st_ino);
  alignas(file_handle) std::array<char, sizeof(file_handle) + MAX_HANDLE_SZ> bytes = {};
  auto* handle = reinterpret_cast<file_handle*>(bytes.data());
  handle->handle_bytes = MAX_HANDLE_SZ;
  int mount = 0;
  if (name_to_handle_at(AT_FDCWD, file.c_str(), handle, &mount, AT_SYMLINK_FOLLOW) == 0) {
    identity.append(bytes.data(), sizeof(file_handle) + handle->handle_bytes);
  }
  return identity;
}

/// The files that this process has read, and the only folder in which it may read.
struct Inputs {
  std::mutex mutex;
  std::set<std::string> files;
  fs::path root;
};
Inputs& TheInputs() {
  static Inputs inputs;
  return inputs;
}

bool IsBelow(const fs::path& path, const fs::path& root) {
  const fs::path rest = path.lexically_relative(root);
  return !rest.empty() && *rest.begin() != "..";
}

std::string KindOf(mode_t mode) {
  if (S_ISDIR(mode)) return "a folder";
  if (S_ISFIFO(mode)) return "a pipe";
  return "a device";
}

}  // namespace

const fs::path& InputFile(const fs::path& file) {
  const auto fail = [&file](const std::string& problem) {
    throw UserError({.place = file.empty() ? "''" : file.string(), .problem = problem});
  };
  RefuseOutside(file);
  struct stat status = {};
  if (stat(file.c_str(), &status) != 0) {
    const bool missing = errno == ENOENT || errno == ENOTDIR;
    fail(missing ? "no such file" : std::string("cannot be read: ") + std::strerror(errno));
  }
  if (!S_ISREG(status.st_mode)) fail("is " + KindOf(status.st_mode) + ", must be a regular file");
  const std::lock_guard lock(TheInputs().mutex);
  TheInputs().files.insert(IdentityOf(file));
  return file;
}

void ReadOnlyInside(const fs::path& folder) {
  std::error_code missing;
  fs::path root = fs::canonical(folder, missing);
  if (missing || !fs::is_directory(root, missing)) {
    throw UserError({.place = "--inside " + folder.string(), .problem = "is not a folder"});
  }
  const std::lock_guard lock(TheInputs().mutex);
  TheInputs().root = std::move(root);
}

fs::path InputRoot() {
  const std::lock_guard lock(TheInputs().mutex);
  return TheInputs().root;
}

bool IsOutside(const fs::path& path) {
  const fs::path root = InputRoot();
  if (root.empty()) return false;
  std::error_code unreadable;
  const fs::path real = fs::weakly_canonical(fs::absolute(path, unreadable), unreadable);
  return unreadable || !(IsBelow(real, root) || !DataName(real).empty());
}

void RefuseOutside(const fs::path& path) {
  if (!IsOutside(path)) return;
  throw UserError(
      {.place = path.string(), .problem = "lies outside --inside " + InputRoot().string()});
}

bool IsInput(const fs::path& path) {
  const std::string identity = IdentityOf(path);
  const std::lock_guard lock(TheInputs().mutex);
  return !identity.empty() && TheInputs().files.contains(identity);
}

}  // namespace gauntlet::sim
