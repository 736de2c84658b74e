#pragma once

#include <fmt/format.h>
#include <pthread.h>

#include <csignal>
#include <system_error>
#include <thread>
#include <vector>

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

/// Threads that end before their owner is destroyed, whatever happens.
class Threads {
 public:
  template <class Work>
  void Start(const Work& work) {
    const WithoutSignals without;
    try {
      threads_.emplace_back(work);
    } catch (const std::system_error& error) {
      throw RunError(fmt::format("cannot start a thread: {}", error.what()));
    }
  }
  void Join() {
    for (std::thread& thread : threads_) thread.join();
    threads_.clear();
  }

 private:
  std::vector<std::thread> threads_;
};

}  // namespace gauntlet::sim
