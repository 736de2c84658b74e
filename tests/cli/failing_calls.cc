// A library for LD_PRELOAD: one call of a program fails, as on a disk that is broken, or all that
// need space from one on, as on a disk that is full.
//
// Environment:
//   GAUNTLET_FAIL_BELOW  a folder with its whole path: only calls on what is in it are counted
//   GAUNTLET_FAIL_CALL   which of them fails, from 1
//   GAUNTLET_FAIL_ERROR  the errno that it fails with
//   GAUNTLET_FAIL_FULL   1: from then on every call fails that needs space
//   GAUNTLET_FAIL_ONLY   a name: only calls of this function are counted
//   GAUNTLET_FAIL_KILL   1: the program is killed in place of the call
//   GAUNTLET_FAIL_LOG    a file that gets the name of the call that failed, at the end `calls N`
#include <dlfcn.h>
#include <fcntl.h>
#include <sys/stat.h>
#include <sys/uio.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <string>

namespace {

std::atomic<long> calls{0};

std::string Setting(const char* name) {
  const char* value = std::getenv(name);
  return value != nullptr ? value : "";
}

template <class Function>
Function* Real(Function* /*own*/, const char* name) {
  return reinterpret_cast<Function*>(dlsym(RTLD_NEXT, name));
}

void Log(const std::string& line) {
  static const auto real_open = Real(&open, "open");
  static const auto real_write = Real(&write, "write");
  static const auto real_close = Real(&close, "close");
  const int file =
      real_open(Setting("GAUNTLET_FAIL_LOG").c_str(), O_WRONLY | O_CREAT | O_APPEND, 0644);
  if (file < 0) return;
  if (real_write(file, line.data(), line.size()) < 0) std::abort();
  real_close(file);
}

enum class Needs { kNothing, kSpace };

bool Fails(const char* call, const std::string& path, Needs needs = Needs::kNothing) {
  static const std::string folder = Setting("GAUNTLET_FAIL_BELOW");
  static const long at = std::strtol(Setting("GAUNTLET_FAIL_CALL").c_str(), nullptr, 10);
  static const bool full = Setting("GAUNTLET_FAIL_FULL") == "1";
  static const std::string only = Setting("GAUNTLET_FAIL_ONLY");
  static const bool kill = Setting("GAUNTLET_FAIL_KILL") == "1";
  if (folder.empty() || !path.starts_with(folder)) return false;
  if (!only.empty() && only != call) return false;
  const long number = ++calls;
  const bool fails = full ? at > 0 && number >= at && needs == Needs::kSpace : number == at;
  if (!fails) return false;
  Log(std::string(call) + " " + path.substr(folder.size()) + "\n");
  if (kill) raise(SIGKILL);
  errno = std::atoi(Setting("GAUNTLET_FAIL_ERROR").c_str());
  return true;
}

std::string PathOf(int file) {
  char path[4096];
  const ssize_t size =
      readlink(("/proc/self/fd/" + std::to_string(file)).c_str(), path, sizeof path);
  return std::string(path, size > 0 ? static_cast<std::size_t>(size) : 0);
}

/// Of a path that begins with a descriptor of the program (/proc/1234/fd/7/name), or that is in the
/// folder of a descriptor.
std::string PathOf(const char* path, int folder = AT_FDCWD) {
  static const std::string descriptors = "/proc/" + std::to_string(getpid()) + "/fd/";
  const std::string text = path;
  if (text.starts_with(descriptors)) {
    const std::size_t end = std::min(text.find('/', descriptors.size()), text.size());
    return PathOf(std::atoi(text.c_str() + descriptors.size())) + text.substr(end);
  }
  return folder == AT_FDCWD || text.starts_with('/') ? text : PathOf(folder) + "/" + text;
}

bool Fails(const char* call, int file, Needs needs = Needs::kNothing) {
  return Fails(call, PathOf(file), needs);
}

Needs NeedsOf(int flags) { return (flags & O_CREAT) != 0 ? Needs::kSpace : Needs::kNothing; }

struct AtTheEnd {
  ~AtTheEnd() { Log("calls " + std::to_string(calls) + "\n"); }
} at_the_end;

}  // namespace

// The C library's, with a failure before them.
extern "C" {

#define GAUNTLET_OPEN(name)                                                           \
  int name(const char* path, int flags, ...) {                                        \
    static const auto real = Real(&name, #name);                                      \
    va_list more;                                                                     \
    va_start(more, flags);                                                            \
    const int mode = va_arg(more, int);                                               \
    va_end(more);                                                                     \
    return Fails(#name, PathOf(path), NeedsOf(flags)) ? -1 : real(path, flags, mode); \
  }
GAUNTLET_OPEN(open)
GAUNTLET_OPEN(open64)

#define GAUNTLET_OPENAT(name)                                                                    \
  int name(int folder, const char* path, int flags, ...) {                                       \
    static const auto real = Real(&name, #name);                                                 \
    va_list more;                                                                                \
    va_start(more, flags);                                                                       \
    const int mode = va_arg(more, int);                                                          \
    va_end(more);                                                                                \
    return Fails(#name, PathOf(path, folder), NeedsOf(flags)) ? -1                               \
                                                              : real(folder, path, flags, mode); \
  }
GAUNTLET_OPENAT(openat)
GAUNTLET_OPENAT(openat64)

#define GAUNTLET_FOPEN(name)                                        \
  FILE* name(const char* path, const char* mode) {                  \
    static const auto real = Real(&name, #name);                    \
    return Fails(#name, PathOf(path)) ? nullptr : real(path, mode); \
  }
GAUNTLET_FOPEN(fopen)
GAUNTLET_FOPEN(fopen64)

ssize_t read(int file, void* data, size_t size) {
  static const auto real = Real(&read, "read");
  return Fails("read", file) ? -1 : real(file, data, size);
}
ssize_t pread(int file, void* data, size_t size, off_t offset) {
  static const auto real = Real(&pread, "pread");
  return Fails("pread", file) ? -1 : real(file, data, size, offset);
}
ssize_t pread64(int file, void* data, size_t size, off_t offset) {
  static const auto real = Real(&pread64, "pread64");
  return Fails("pread64", file) ? -1 : real(file, data, size, offset);
}
ssize_t write(int file, const void* data, size_t size) {
  static const auto real = Real(&write, "write");
  return Fails("write", file, Needs::kSpace) ? -1 : real(file, data, size);
}
ssize_t writev(int file, const iovec* parts, int count) {
  static const auto real = Real(&writev, "writev");
  return Fails("writev", file, Needs::kSpace) ? -1 : real(file, parts, count);
}
ssize_t pwrite(int file, const void* data, size_t size, off_t offset) {
  static const auto real = Real(&pwrite, "pwrite");
  return Fails("pwrite", file, Needs::kSpace) ? -1 : real(file, data, size, offset);
}
ssize_t pwrite64(int file, const void* data, size_t size, off_t offset) {
  static const auto real = Real(&pwrite64, "pwrite64");
  return Fails("pwrite64", file, Needs::kSpace) ? -1 : real(file, data, size, offset);
}
int fsync(int file) {
  static const auto real = Real(&fsync, "fsync");
  return Fails("fsync", file, Needs::kSpace) ? -1 : real(file);
}
int fdatasync(int file) {
  static const auto real = Real(&fdatasync, "fdatasync");
  return Fails("fdatasync", file, Needs::kSpace) ? -1 : real(file);
}
int ftruncate(int file, off_t size) noexcept {
  static const auto real = Real(&ftruncate, "ftruncate");
  return Fails("ftruncate", file, Needs::kSpace) ? -1 : real(file, size);
}
int ftruncate64(int file, off_t size) noexcept {
  static const auto real = Real(&ftruncate64, "ftruncate64");
  return Fails("ftruncate64", file, Needs::kSpace) ? -1 : real(file, size);
}
int renameat(int from_folder, const char* from, int to_folder, const char* to) noexcept {
  static const auto real = Real(&renameat, "renameat");
  if (Fails("renameat", PathOf(to, to_folder))) return -1;
  return real(from_folder, from, to_folder, to);
}
int mkdir(const char* path, mode_t mode) noexcept {
  static const auto real = Real(&mkdir, "mkdir");
  return Fails("mkdir", PathOf(path), Needs::kSpace) ? -1 : real(path, mode);
}
int mkdirat(int folder, const char* path, mode_t mode) noexcept {
  static const auto real = Real(&mkdirat, "mkdirat");
  return Fails("mkdirat", PathOf(path, folder), Needs::kSpace) ? -1 : real(folder, path, mode);
}
int close(int file) {  // it is closed all the same
  static const auto real = Real(&close, "close");
  const bool fails = Fails("close", file);
  const int error = errno;
  const int result = real(file);
  if (!fails) return result;
  errno = error;
  return -1;
}

}  // extern "C"
