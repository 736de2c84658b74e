#include "sim/cli/interrupt.h"

#include <sys/time.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <csignal>
#include <exception>
#include <string>
#include <string_view>

#include "sim/base/output_file.h"
#include "sim/base/stop.h"
#include "sim/cli/standard_streams.h"
#include "sim/study/trial_table/trial_table.h"

// In handlers: system calls and lock-free numbers only.
static_assert(std::atomic<int>::is_always_lock_free);
static_assert(std::atomic<const char*>::is_always_lock_free);

namespace gauntlet::sim {
namespace {

constexpr int kOfSignals = 128;   // an exit code of shells: 128 + signal
constexpr int kPatienceMs = 500;  // to hear a signal: with the rest, the program ends within 1 s
constexpr int kMomentMs = 20;     // between two looks whether files are no longer being changed
constexpr int kMoments = 50;      // then it ends all the same

std::atomic<bool> at_once{false};
std::atomic<bool> has_time{false};
std::atomic<bool> told{false};  // or being told: that it was interrupted
std::atomic<int> moments_left{kMoments};
std::atomic<const char*> what_is_kept{""};

/// Calls the handler of SIGALRM.
void ComeBackIn(int time_ms) {
  const itimerval timer = {.it_interval = {}, .it_value = {.tv_sec = 0, .tv_usec = 1000 * time_ms}};
  setitimer(ITIMER_REAL, &timer, nullptr);
}

void EndWhenFilesAreWhole(int) {
  const int error = errno;
  if (Unbroken::Any() && moments_left-- > 0) {
    ComeBackIn(kMomentMs);
    errno = error;
    return;
  }
  RemoveUncommittedFiles();
  if (told.exchange(true)) _exit(kOfSignals + stop_signal);  // who tells it has had its time
  for (const std::string_view text :
       {std::string_view("gauntlet: "), kInterrupted, std::string_view(what_is_kept.load()),
        std::string_view("\n")}) {
    SayText(text);
  }
  _exit(kOfSignals + stop_signal);
}

void OnSignal(int signal) {
  int none = 0;
  const bool first = stop_signal.compare_exchange_strong(none, signal);
  if ((!first && !told) || at_once) return EndWhenFilesAreWhole(signal);
  if (has_time) return;
  const int error = errno;
  ComeBackIn(kPatienceMs);
  errno = error;
}

void Handle(int signal, void (*handler)(int)) {
  struct sigaction action = {};
  sigaction(signal, nullptr, &action);
  if (action.sa_handler == SIG_IGN) return;
  action = {};
  action.sa_handler = handler;
  action.sa_flags = SA_RESTART;
  sigaction(signal, &action, nullptr);
}

}  // namespace

void CatchSignals() {
  Handle(SIGALRM, EndWhenFilesAreWhole);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGQUIT}) Handle(signal, OnSignal);
  for (const int signal : {SIGPIPE, SIGXFSZ}) Handle(signal, SIG_IGN);
}

void EndAtSignals() { at_once = true; }

EndsAtSecondSignal::EndsAtSecondSignal() { has_time = true; }
EndsAtSecondSignal::~EndsAtSecondSignal() {
  has_time = false;
  // What is being cancelled ends the program with the code of the signal.
  if (std::uncaught_exceptions() == 0) stop_signal = 0;
}

const std::filesystem::path& KeepsTrials(const std::filesystem::path& file) {
  static std::string kept;  // for the handler, as long as there is one
  kept = "; finished trials are " + KeptIn(file);
  what_is_kept = kept.c_str();
  return file;
}

int ExitCodeOfStop() {
  while (told.exchange(true)) pause();  // a handler in another thread ends the program
  ComeBackIn(0);                        // never
  return kOfSignals + stop_signal;
}

}  // namespace gauntlet::sim
