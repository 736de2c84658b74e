#pragma once

#include <fcntl.h>
#include <sqlite3.h>
#include <unistd.h>

#include <cerrno>
#include <cstddef>

namespace gauntlet::test {

/// A system call of SQLite's fails from now on, until the end of the scope.
class FailingCall {
 public:
  template <class Function>
  FailingCall(const char* name, Function* replacement) {
    sqlite3_vfs* vfs = sqlite3_vfs_find(nullptr);
    vfs->xSetSystemCall(vfs, name, reinterpret_cast<sqlite3_syscall_ptr>(replacement));
  }
  ~FailingCall() {
    sqlite3_vfs* vfs = sqlite3_vfs_find(nullptr);
    vfs->xSetSystemCall(vfs, nullptr, nullptr);
  }
  FailingCall(const FailingCall&) = delete;
  FailingCall& operator=(const FailingCall&) = delete;
};

inline int NoLocks(int /*descriptor*/, int command, ...) {
  if (command == F_GETLK || command == F_SETLK) errno = ENOLCK;
  return -1;
}
inline ssize_t NothingToRead(int /*descriptor*/, void* /*buffer*/, std::size_t /*count*/,
                             off_t /*offset*/) {
  errno = EIO;
  return -1;
}
inline ssize_t NothingTaken(int /*descriptor*/, const void* /*buffer*/, std::size_t /*count*/,
                            off_t /*offset*/) {
  errno = EIO;
  return -1;
}
inline ssize_t NoSpace(int /*descriptor*/, const void* /*buffer*/, std::size_t /*count*/,
                       off_t /*offset*/) {
  errno = ENOSPC;
  return -1;
}
inline const char* const kRead = sizeof(off_t) == 8 ? "pread64" : "pread";
inline const char* const kWrite = sizeof(off_t) == 8 ? "pwrite64" : "pwrite";

}  // namespace gauntlet::test
