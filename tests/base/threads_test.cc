#include "sim/base/threads.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <stdexcept>
#include <thread>
#include <vector>

#include "sim/base/error.h"

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

/// A failure stops the other threads, and one of them may end before the failure is thrown.
TEST(Threads, ThrowWhatFailedAndNotThatTheOthersWereStopped) {
  for (const bool is_failure_first : {false, true}) {
    std::atomic<int> calls{0};
    std::atomic<bool> has_first_thrown{false};
    const auto work = [&] {
      const bool is_first = calls++ == 0;
      struct Ends {
        std::atomic<bool>* ended;
        ~Ends() {
          if (ended) *ended = true;
        }
      } const ends{is_first ? &has_first_thrown : nullptr};
      if (!is_first) {
        while (!has_first_thrown) std::this_thread::yield();
        std::this_thread::sleep_for(std::chrono::milliseconds(20));  // until it is kept
      }
      if (is_first == is_failure_first) throw RunError("the reason");
      throw Cancelled{};
    };
    EXPECT_THROW(RunOnThreads(2, work), RunError) << is_failure_first;
  }
  EXPECT_THROW(RunOnThreads(2, [] { throw Cancelled{}; }), Cancelled);
}

}  // namespace
}  // namespace gauntlet::sim
