#pragma once

#include <cstddef>
#include <functional>
#include <string>

namespace gauntlet::sim {

/// `jobs`, or the number of processors for 0.
int JobsOrCores(int jobs);

/// Called if the system starts fewer threads: their number, and the reason.
using FewerThreads = std::function<void(std::size_t started, const std::string& reason)>;

/// Runs `work` on `count` threads, the caller's included, and returns when all have ended. `work`
/// takes tasks until there are none, so fewer threads do the same work. The first exception of
/// `work` is thrown again after all threads have ended; Cancelled only if there is no other: the
/// threads that a failure stops may be faster than the one that fails.
void RunOnThreads(std::size_t count, const std::function<void()>& work,
                  const FewerThreads& fewer = {});

/// Calls task(0) to task(count - 1) on this number of threads, in any order.
void ForEachOnThreads(std::size_t threads, std::size_t count,
                      const std::function<void(std::size_t)>& task);

}  // namespace gauntlet::sim
