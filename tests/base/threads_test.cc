#include "sim/base/threads.h"

#include <gtest/gtest.h>

#include <atomic>
#include <stdexcept>
#include <vector>

namespace gauntlet::sim {
namespace {

TEST(Threads, DoEachTaskOnce) {
  for (const std::size_t threads : {1, 2, 7, 100}) {
    for (const std::size_t count : {0, 1, 5, 1000}) {
      std::vector<std::atomic<int>> done(count);
      ForEachOnThreads(threads, count, [&](std::size_t i) { ++done[i]; });
      for (const auto& times : done) EXPECT_EQ(times, 1);
    }
  }
}

TEST(Threads, CallTheWorkInEach) {
  std::atomic<int> calls{0};
  RunOnThreads(3, [&] { ++calls; });
  EXPECT_EQ(calls, 3);
}

TEST(Threads, ThrowAgainWhatATaskThrewAndBeginNoMore) {
  for (const std::size_t threads : {1, 4}) {
    std::atomic<int> begun{0};
    const auto fail = [&](std::size_t i) {
      ++begun;
      if (i == 3) throw std::runtime_error("the third");
    };
    EXPECT_THROW(ForEachOnThreads(threads, 100000, fail), std::runtime_error);
    EXPECT_GE(begun, 4);
    if (threads == 1) {
      EXPECT_EQ(begun, 4);
    }
  }
}

}  // namespace
}  // namespace gauntlet::sim
