#include "sim/video/frame_clock.h"

#include <gtest/gtest.h>

namespace gauntlet::sim {
namespace {

TEST(FrameClock, NeverDrifts) {
  const FrameClock clock(1000.0, 30, 100'000'000);
  EXPECT_EQ(clock.Sample(0), 0);
  EXPECT_EQ(clock.Sample(1), 33);
  EXPECT_EQ(clock.Sample(2), 66);
  EXPECT_EQ(clock.Sample(3), 100);
  for (int hour = 1; hour <= 24; ++hour) EXPECT_EQ(clock.Sample(hour * 108000), hour * 3'600'000);
}

TEST(FrameClock, CountsExactlyTheFramesThatHaveASample) {
  for (double rate_hz : {30.0, 100.0, 999.5, 1000.0}) {
    for (int frames_per_s : {1, 24, 30, 60}) {
      for (int samples : {1, 33, 34, 1000, 9999}) {
        const FrameClock clock(rate_hz, frames_per_s, samples);
        const int frames = clock.FrameCount();
        EXPECT_LT(clock.Sample(frames - 1), samples);
        EXPECT_GE(clock.Sample(frames), samples);
      }
    }
  }
}

TEST(FrameClock, TenSecondsAreThreeHundredFrames) {
  EXPECT_EQ(FrameClock(1000.0, 30, 10'000).FrameCount(), 300);
}

}  // namespace
}  // namespace gauntlet::sim
