#include "sim/base/output_folder.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "sim/base/error.h"
#include "sim/base/output_file.h"

namespace gauntlet::sim {

namespace fs = std::filesystem;

OutputFolder::OutputFolder(fs::path path) : path_(std::move(path)) {
  std::error_code ignored;
  if (fs::exists(path_, ignored) && !fs::is_directory(path_, ignored)) {
    throw UserError({.place = "--out " + path_.string(), .problem = "is a file, must be a folder"});
  }
  for (fs::path p = fs::absolute(path_).lexically_normal(); !p.empty() && !fs::exists(p, ignored);
       p = p.parent_path()) {
    if (p.has_filename()) made_.push_back(p);
  }
  MakeDirectory(path_);
  for (const fs::path& folder : made_) RemoveIfEmptyLater(folder);
  if (access(path_.c_str(), W_OK | X_OK) != 0) {
    throw RunError(
        fmt::format("{}: cannot write into the folder: {}", path_.string(), std::strerror(errno)));
  }
  // A file system without locks is no reason to stop: only a lock that another holds is.
  lock_.Set(open(path_.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (flock(lock_.get(), LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
    throw RunError(fmt::format(
        "{}: another gauntlet writes into this folder; wait for its end, or give another --out",
        path_.string()));
  }
}

OutputFolder::~OutputFolder() {
  lock_.Close();
  if (keep_) return;
  std::error_code ignored;
  // Only folders that this object made, and only while they are empty.
  for (const fs::path& folder : made_) {
    if (!fs::remove(folder, ignored)) return;
  }
}

}  // namespace gauntlet::sim
