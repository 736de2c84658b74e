#include "sim/base/threads.h"

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <system_error>
#include <thread>
#include <vector>

#include "sim/base/error.h"

namespace gauntlet::sim {

int JobsOrCores(int jobs) {
  return jobs > 0 ? jobs : std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
}

void RunOnThreads(std::size_t count, const std::function<void()>& work, const FewerThreads& fewer) {
  std::mutex mutex;
  std::exception_ptr error;
  bool is_cancelled = false;
  const auto run = [&] {
    try {
      work();
    } catch (const Cancelled&) {
      const std::lock_guard lock(mutex);
      if (!error) {
        error = std::current_exception();
        is_cancelled = true;
      }
    } catch (...) {
      const std::lock_guard lock(mutex);
      if (!error || is_cancelled) error = std::current_exception();
      is_cancelled = false;
    }
  };
  std::vector<std::jthread> others;
  try {
    while (others.size() + 1 < count) others.emplace_back(run);
  } catch (const std::system_error& problem) {
    if (fewer) fewer(others.size() + 1, problem.code().message());
  }
  run();
  others.clear();
  if (error) std::rethrow_exception(error);
}

void ForEachOnThreads(std::size_t threads, std::size_t count,
                      const std::function<void(std::size_t)>& task) {
  std::atomic<std::size_t> next{0};
  RunOnThreads(std::min(threads, count), [&] {
    for (std::size_t i = next++; i < count; i = next++) {
      try {
        task(i);
      } catch (...) {
        next = count;  // ends the other threads
        throw;
      }
    }
  });
}

}  // namespace gauntlet::sim
