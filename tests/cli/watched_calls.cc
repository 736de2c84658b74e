// A library for LD_PRELOAD: writes down who opens a connection or starts another program.
//
// Environment: GAUNTLET_WATCH_LOG, a file that gets a line for each such call.
#include <dlfcn.h>
#include <fcntl.h>
#include <spawn.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cstdlib>
#include <string>

namespace {

void Log(const std::string& line) {
  const char* name = std::getenv("GAUNTLET_WATCH_LOG");
  const int file = name == nullptr ? -1 : open(name, O_WRONLY | O_CREAT | O_APPEND, 0644);
  if (file < 0) return;
  if (write(file, (line + "\n").data(), line.size() + 1) < 0) std::abort();
  close(file);
}

template <class Function>
Function* Real(Function* /*own*/, const char* name) {
  return reinterpret_cast<Function*>(dlsym(RTLD_NEXT, name));
}

}  // namespace

extern "C" {

int socket(int domain, int type, int protocol) noexcept {
  Log("socket");
  return Real(&socket, "socket")(domain, type, protocol);
}
int execve(const char* path, char* const arguments[], char* const environment[]) noexcept {
  Log(std::string("execve ") + path);
  return Real(&execve, "execve")(path, arguments, environment);
}
int execvp(const char* path, char* const arguments[]) noexcept {
  Log(std::string("execvp ") + path);
  return Real(&execvp, "execvp")(path, arguments);
}
int posix_spawn(pid_t* process, const char* path, const posix_spawn_file_actions_t* actions,
                const posix_spawnattr_t* attributes, char* const arguments[],
                char* const environment[]) {
  Log(std::string("posix_spawn ") + path);
  return Real(&posix_spawn, "posix_spawn")(process, path, actions, attributes, arguments,
                                           environment);
}
int system(const char* command) {
  Log(std::string("system ") + command);
  return Real(&system, "system")(command);
}
FILE* popen(const char* command, const char* mode) {
  Log(std::string("popen ") + command);
  return Real(&popen, "popen")(command, mode);
}

}  // extern "C"
