#include "sim/cli/interrupt.h"

#include <unistd.h>

#include <csignal>

#include "sim/base/atomic_file.h"

namespace gauntlet::sim {
namespace {

volatile std::sig_atomic_t interrupted = 0;

void OnSignal(int) {
  if (interrupted != 0) {
    RemoveUncommittedFiles();
    _exit(130);
  }
  interrupted = 1;
}

void Handle(void (*handler)(int)) {
  struct sigaction action = {};
  action.sa_handler = handler;
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
}

}  // namespace

void CatchInterrupts() { Handle(OnSignal); }

void EndAtInterrupts() { Handle(SIG_DFL); }

bool Interrupted() { return interrupted != 0; }

}  // namespace gauntlet::sim
