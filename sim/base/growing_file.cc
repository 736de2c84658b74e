#include "sim/base/growing_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>

#include "sim/base/error.h"
#include "sim/base/output_file.h"

namespace gauntlet::sim {

GrowingFile::GrowingFile(std::filesystem::path target) : target_(std::move(target)) {
  const std::filesystem::path parent = target_.has_parent_path() ? target_.parent_path() : ".";
  folder_.Set(open(parent.c_str(), O_PATH | O_DIRECTORY | O_CLOEXEC));
  if (folder_.is_open()) {
    file_.Set(openat(folder_.get(), target_.filename().c_str(),
                     O_WRONLY | O_CREAT | O_EXCL | O_APPEND | O_NOFOLLOW | O_CLOEXEC, 0666));
  }
  const int error = errno;
  if (file_.is_open()) {  // its name is on the disk, too; some file systems cannot do this
    const Descriptor readable(openat(folder_.get(), ".", O_RDONLY | O_DIRECTORY | O_CLOEXEC));
    static_cast<void>(fsync(readable.get()));
    return;
  }
  if (error == EEXIST) {
    throw UserError({.place = target_.string(),
                     .problem = "exists already, and a recording is not replaced; --record or "
                                "--out names another place"});
  }
  throw RunError(fmt::format("{}: cannot write: {}", target_.string(), std::strerror(error)));
}

bool GrowingFile::Add(std::string_view line) {
  if (waiting_.size() + line.size() > kMostWaitingBytes) return false;
  waiting_ += line;
  return true;
}

void GrowingFile::Fail(std::string_view action, int error) {
  problem_ = fmt::format("{}: cannot {}: {}", target_.string(), action, std::strerror(error));
}

void GrowingFile::Flush() {
  if (!file_.is_open() || waiting_.empty()) return;
  std::size_t end = written_;
  int error = 0;
  while (end < waiting_.size() && error == 0) {
    const ssize_t size = write(file_.get(), waiting_.data() + end, waiting_.size() - end);
    if (size > 0) {
      end += static_cast<std::size_t>(size);
    } else if (size == 0 || errno != EINTR) {
      error = size == 0 ? ENOSPC : errno;
    }
  }
  lines_ += std::count(waiting_.begin() + static_cast<std::ptrdiff_t>(written_),
                       waiting_.begin() + static_cast<std::ptrdiff_t>(end), '\n');
  const std::size_t whole = end == 0 ? 0 : waiting_.rfind('\n', end - 1) + 1;  // npos + 1 is 0
  waiting_.erase(0, whole);
  written_ = end - whole;
  if (error != 0) return Fail("write", error);
  // A file system without this is no reason to stop.
  if (fdatasync(file_.get()) != 0 && errno != EINVAL && errno != ENOSYS && errno != EROFS) {
    Fail("write to the disk", errno);
    may_lack_lines_ = true;
  }
  if (!may_lack_lines_) problem_.clear();
}

void GrowingFile::End() {
  if (!file_.is_open()) return;
  Flush();
  struct stat status = {};
  if (written_ > 0 && fstat(file_.get(), &status) == 0) {
    static_cast<void>(ftruncate(file_.get(), status.st_size - static_cast<off_t>(written_)));
  }
  if (lines_ == 0) return Remove();
  file_.Close();
}

void GrowingFile::Remove() {
  file_.Close();
  unlinkat(folder_.get(), target_.filename().c_str(), 0);
}

}  // namespace gauntlet::sim
