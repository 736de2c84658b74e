#pragma once

#include <cstddef>
#include <functional>
#include <string>

namespace gauntlet::sim {

/// Told how many threads there are where the system starts no more, and why.
using FewerThreads = std::function<void(std::size_t started, const std::string& reason)>;

/// Calls `work` on `count` threads at once, of which the caller's is one, and comes back when all
/// have: who calls it gives out tasks until there are none. Fewer threads do the same work. What
/// `work` throws first is thrown again when all have ended.
void RunOnThreads(std::size_t count, const std::function<void()>& work,
                  const FewerThreads& fewer = {});

/// Calls task(0) to task(count - 1), on so many threads, in any order.
void ForEachOnThreads(std::size_t threads, std::size_t count,
                      const std::function<void(std::size_t)>& task);

}  // namespace gauntlet::sim
