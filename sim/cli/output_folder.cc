#include "sim/cli/output_folder.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "sim/base/atomic_file.h"
#include "sim/base/error.h"

namespace gauntlet::sim {

namespace fs = std::filesystem;

OutputFolder::OutputFolder(fs::path path) : path_(std::move(path)) {
  std::error_code ignored;
  for (fs::path p = fs::absolute(path_).lexically_normal(); !p.empty() && !fs::exists(p, ignored);
       p = p.parent_path()) {
    if (p.has_filename()) first_made_ = p;
  }
  MakeDirectory(path_);
  if (!fs::is_directory(path_, ignored)) {
    throw RunError(fmt::format("{}: is not a folder", path_.string()));
  }
  if (access(path_.c_str(), W_OK) != 0) {
    throw RunError(
        fmt::format("{}: cannot write into the folder: {}", path_.string(), std::strerror(errno)));
  }
}

OutputFolder::~OutputFolder() {
  if (keep_ || first_made_.empty()) return;
  std::error_code ignored;
  // Only folders that this object made, and only while they are empty, from the inside out.
  for (fs::path p = fs::absolute(path_).lexically_normal();
       p.native().size() >= first_made_.native().size(); p = p.parent_path()) {
    if (!p.has_filename()) continue;
    if (!fs::remove(p, ignored)) return;
  }
}

}  // namespace gauntlet::sim
