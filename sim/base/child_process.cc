#include "sim/base/child_process.h"

#include <fmt/format.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <system_error>
#include <utility>

namespace gauntlet::sim {

ChildProcess::ChildProcess(const std::function<void()>& work) {
  // Signals are blocked until the child has replaced the parent's handlers, which would remove
  // files.
  sigset_t all;
  sigset_t before;
  sigfillset(&all);
  pthread_sigmask(SIG_SETMASK, &all, &before);
  const pid_t parent = getpid();
  process_ = fork();
  if (process_ == 0) {
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (getppid() != parent) _exit(0);  // the parent ended before prctl() took effect
    for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGQUIT}) std::signal(signal, SIG_IGN);
    sigset_t none;
    sigemptyset(&none);
    pthread_sigmask(SIG_SETMASK, &none, nullptr);
    work();
    _exit(0);
  }
  const std::error_code reason(errno, std::generic_category());
  pthread_sigmask(SIG_SETMASK, &before, nullptr);
  if (process_ < 0) throw std::system_error(reason);
}

ChildProcess::~ChildProcess() {
  Kill();
  Wait();
}

void ChildProcess::Kill() {
  if (process_ > 0) kill(process_, SIGKILL);
}

bool ChildProcess::HasEnded() const {
  if (process_ < 0) return true;
  siginfo_t info = {};
  const auto id = static_cast<id_t>(process_);
  return waitid(P_PID, id, &info, WEXITED | WNOHANG | WNOWAIT) != 0 || info.si_pid != 0;
}

std::optional<ChildEnd> ChildProcess::Wait() {
  const pid_t process = std::exchange(process_, -1);
  if (process < 0) return std::nullopt;
  int status = 0;
  while (waitpid(process, &status, 0) < 0) {
    if (errno != EINTR) return std::nullopt;
  }
  if (WIFSIGNALED(status)) return ChildEnd{.signal = WTERMSIG(status), .exit_code = 0};
  return ChildEnd{.signal = 0, .exit_code = WEXITSTATUS(status)};
}

std::string TextOf(const ChildEnd& end) {
  if (end.signal == 0) return fmt::format("ended with exit code {}", end.exit_code);
  return fmt::format("ended by signal {} ({})", end.signal, sigdescr_np(end.signal));
}

}  // namespace gauntlet::sim
