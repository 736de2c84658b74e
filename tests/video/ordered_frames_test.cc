#include "sim/video/ordered_frames.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <stdexcept>
#include <thread>
#include <vector>

namespace gauntlet::sim {
namespace {

/// Writes its number into the image, after a while that differs from frame to frame.
void DrawNumber(int frame, Image& image) {
  std::this_thread::sleep_for(std::chrono::microseconds(200 * (frame * 7 % 5)));
  image = Image(1, 1);
  image.pixels[0] = static_cast<std::uint32_t>(frame);
}

FrameDrawer MakeNumberDrawer() { return DrawNumber; }

TEST(OrderedFrames, HandsOverEveryFrameOnceInOrder) {
  for (int jobs : {1, 2, 5, 200}) {
    std::vector<std::uint32_t> taken;
    EXPECT_TRUE(DrawFramesInOrder(100, jobs, MakeNumberDrawer, [&](int frame, const Image& image) {
      EXPECT_EQ(image.pixels[0], static_cast<std::uint32_t>(frame));
      taken.push_back(image.pixels[0]);
      return true;
    }));
    ASSERT_EQ(taken.size(), 100u);
    for (std::uint32_t i = 0; i < 100; ++i) EXPECT_EQ(taken[i], i);
  }
}

TEST(OrderedFrames, NeverHoldsMoreFramesThanPromised) {
  constexpr int kJobs = 3, kFrames = 200;
  std::atomic<int> begun = 0;
  int taken = 0, most = 0;
  DrawFramesInOrder(
      kFrames, kJobs,
      [&]() -> FrameDrawer {
        return [&](int frame, Image& image) {
          ++begun;
          DrawNumber(0, image);
          (void)frame;
        };
      },
      [&](int, const Image&) {
        std::this_thread::sleep_for(std::chrono::milliseconds(1));  // slower than the threads
        most = std::max(most, begun.load() - taken);
        ++taken;
        return true;
      });
  EXPECT_EQ(taken, kFrames);
  EXPECT_LE(most, FramesInFlight(kJobs));
  EXPECT_GT(most, kJobs);  // and the threads do run ahead
}

TEST(OrderedFrames, StopsWhenTheTakerSaysSo) {
  std::atomic<int> begun = 0;
  int taken = 0;
  const bool complete = DrawFramesInOrder(
      100000, 2, [&]() -> FrameDrawer { return [&](int, Image&) { ++begun; }; },
      [&](int, const Image&) { return ++taken < 10; });
  EXPECT_FALSE(complete);
  EXPECT_EQ(taken, 10);
  EXPECT_LE(begun, 10 + FramesInFlight(2));
}

TEST(OrderedFrames, PassesOnWhatGoesWrongWhereverItDoes) {
  const auto take = [](int, const Image&) { return true; };
  const auto fail_to_make = []() -> FrameDrawer { throw std::runtime_error("no context"); };
  const auto fail_to_draw = []() -> FrameDrawer {
    return [](int frame, Image&) {
      if (frame == 7) throw std::runtime_error("no frame");
    };
  };
  EXPECT_THROW(DrawFramesInOrder(50, 2, fail_to_make, take), std::runtime_error);
  EXPECT_THROW(DrawFramesInOrder(50, 2, fail_to_draw, take), std::runtime_error);
  EXPECT_THROW(
      DrawFramesInOrder(50, 2, MakeNumberDrawer,
                        [](int, const Image&) -> bool { throw std::runtime_error("full"); }),
      std::runtime_error);
}

}  // namespace
}  // namespace gauntlet::sim
