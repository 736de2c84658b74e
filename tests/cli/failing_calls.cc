// A library for LD_PRELOAD: one call of a program fails, as on a disk that is full or broken.
//
// Environment:
//   GAUNTLET_FAIL_BELOW  a folder with its whole path: only calls on what is in it are counted
//   GAUNTLET_FAIL_CALL   which of them fails, from 1
//   GAUNTLET_FAIL_ERROR  the errno that it fails with
//   GAUNTLET_FAIL_LOG    a file that gets the name of the call that failed, at the end `calls N`
#include <dlfcn.h>
#include <fcntl.h>
#include <sys/stat.h>
#include <sys/uio.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
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

bool Fails(const char* call, const std::string& path) {
  static const std::string folder = Setting("GAUNTLET_FAIL_BELOW");
  static const long at = std::strtol(Setting("GAUNTLET_FAIL_CALL").c_str(), nullptr, 10);
  if (folder.empty() || !path.starts_with(folder)) return false;
  if (++calls != at) return false;
  Log(std::string(call) + " " + path.substr(folder.size()) + "\n");
  errno = std::atoi(Setting("GAUNTLET_FAIL_ERROR").c_str());
  return true;
}

bool Fails(const char* call, int file) {
  char path[4096];
  const ssize_t size =
      readlink(("/proc/self/fd/" + std::to_string(file)).c_str(), path, sizeof path);
  return size > 0 && Fails(call, std::string(path, static_cast<std::size_t>(size)));
}

struct AtTheEnd {
  ~AtTheEnd() { Log("calls " + std::to_string(calls) + "\n"); }
} at_the_end;

}  // namespace

// The C library's, with a failure before them.
extern "C" {

#define GAUNTLET_OPEN(name)                                   \
  int name(const char* path, int flags, ...) {                \
    static const auto real = Real(&name, #name);              \
    va_list more;                                             \
    va_start(more, flags);                                    \
    const int mode = va_arg(more, int);                       \
    va_end(more);                                             \
    return Fails(#name, path) ? -1 : real(path, flags, mode); \
  }
GAUNTLET_OPEN(open)
GAUNTLET_OPEN(open64)

#define GAUNTLET_FOPEN(name)                                \
  FILE* name(const char* path, const char* mode) {          \
    static const auto real = Real(&name, #name);            \
    return Fails(#name, path) ? nullptr : real(path, mode); \
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
  return Fails("write", file) ? -1 : real(file, data, size);
}
ssize_t writev(int file, const iovec* parts, int count) {
  static const auto real = Real(&writev, "writev");
  return Fails("writev", file) ? -1 : real(file, parts, count);
}
ssize_t pwrite(int file, const void* data, size_t size, off_t offset) {
  static const auto real = Real(&pwrite, "pwrite");
  return Fails("pwrite", file) ? -1 : real(file, data, size, offset);
}
ssize_t pwrite64(int file, const void* data, size_t size, off_t offset) {
  static const auto real = Real(&pwrite64, "pwrite64");
  return Fails("pwrite64", file) ? -1 : real(file, data, size, offset);
}
int fsync(int file) {
  static const auto real = Real(&fsync, "fsync");
  return Fails("fsync", file) ? -1 : real(file);
}
int fdatasync(int file) {
  static const auto real = Real(&fdatasync, "fdatasync");
  return Fails("fdatasync", file) ? -1 : real(file);
}
int ftruncate(int file, off_t size) noexcept {
  static const auto real = Real(&ftruncate, "ftruncate");
  return Fails("ftruncate", file) ? -1 : real(file, size);
}
int ftruncate64(int file, off_t size) noexcept {
  static const auto real = Real(&ftruncate64, "ftruncate64");
  return Fails("ftruncate64", file) ? -1 : real(file, size);
}
int rename(const char* from, const char* to) noexcept {
  static const auto real = Real(&rename, "rename");
  return Fails("rename", to) ? -1 : real(from, to);
}
int mkdir(const char* path, mode_t mode) noexcept {
  static const auto real = Real(&mkdir, "mkdir");
  return Fails("mkdir", path) ? -1 : real(path, mode);
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
