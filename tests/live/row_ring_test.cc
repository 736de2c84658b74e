#include "sim/live/row_ring.h"

#include <gtest/gtest.h>

#include <array>
#include <cstddef>
#include <span>
#include <thread>
#include <vector>

namespace gauntlet::sim {
namespace {

TEST(RowRing, RefusesARowBeyondItsSizeAndKeepsTheOthers) {
  RowRing<int> ring(4, 1);
  for (int i = 0; i < 4; ++i) EXPECT_TRUE(ring.Push(i, std::array{10.0 * i}));
  EXPECT_FALSE(ring.Push(4, std::array{40.0}));
  std::vector<double> popped;
  while (ring.Pop(
      [&](int head, std::span<const double> values) { popped.push_back(values[0] + head); })) {
  }
  EXPECT_EQ(popped, (std::vector<double>{0.0, 11.0, 22.0, 33.0}));
  EXPECT_TRUE(ring.Push(5, std::array{50.0}));
}

TEST(RowRing, PassesEveryRowInOrderBetweenTwoThreads) {
  constexpr int kRows = 20000;
  RowRing<int> ring(8, 2);
  std::thread writer([&] {
    for (int i = 0; i < kRows;) {
      if (ring.Push(i, std::array{1.0 * i, -1.0 * i})) {
        ++i;
      } else {
        std::this_thread::yield();
      }
    }
  });
  int next = 0;
  bool is_whole = true;
  while (next < kRows) {
    const bool found = ring.Pop([&](int head, std::span<const double> values) {
      is_whole = is_whole && head == next && values[0] == next && values[1] == -next;
      ++next;
    });
    if (!found) std::this_thread::yield();
  }
  writer.join();
  EXPECT_TRUE(is_whole);
  EXPECT_EQ(ring.waiting(), std::size_t{0});
}

}  // namespace
}  // namespace gauntlet::sim
