#pragma once

#include <fmt/format.h>
#include <pthread.h>

#include <csignal>
#include <system_error>
#include <thread>
#include <utility>

#include "sim/base/error.h"

namespace gauntlet::sim {

/// Signals are for the thread that waits; the others would only sleep shorter.
class WithoutSignals {
 public:
  WithoutSignals() {
    sigset_t all;
    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, &before_);
  }
  ~WithoutSignals() { pthread_sigmask(SIG_SETMASK, &before_, nullptr); }
  WithoutSignals(const WithoutSignals&) = delete;
  WithoutSignals& operator=(const WithoutSignals&) = delete;

 private:
  sigset_t before_;
};

/// A thread that gets no signals. Its owner asks it to stop and waits for it when it is destroyed.
/// Errors: RunError if no thread starts.
template <class Work>
std::jthread StartThread(Work work) {
  const WithoutSignals without;
  try {
    return std::jthread(std::move(work));
  } catch (const std::system_error& error) {
    throw RunError(fmt::format("cannot start a thread: {}", error.what()));
  }
}

}  // namespace gauntlet::sim
