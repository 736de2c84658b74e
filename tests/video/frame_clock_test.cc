#include "sim/show/video/frame_clock.h"

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

TEST(FrameClock, AnExcerptAtItsSpeed) {
  const FrameClock slow(1000.0, 30, 10'000, {.from_s = 2.0, .to_s = 3.0, .speed = 0.25});
  EXPECT_EQ(slow.FrameCount(), 120);  // 1 s, four times as long
  EXPECT_EQ(slow.Sample(0), 2000);
  EXPECT_EQ(slow.Sample(60), 2500);
  EXPECT_DOUBLE_EQ(slow.Time_s(60), 2.5);
  EXPECT_LT(slow.Sample(119), 3000);
  const FrameClock fast(1000.0, 30, 10'000, {.speed = 4.0});
  EXPECT_EQ(fast.FrameCount(), 75);
  EXPECT_EQ(FrameClock(33.3, 30, 333, {.to_s = 99.0}).end, 333);
  EXPECT_EQ(FrameClock(1000.0, 30, 10'000, {.from_s = 10.0}).FrameCount(), 0);
  const FrameClock hour(1000.0, 120, 3'600'000, {.speed = 0.01});
  EXPECT_EQ(hour.FrameCount(), 43'200'000);
  EXPECT_EQ(hour.Sample(43'199'988), 3'599'999);
}

TEST(FrameClock, FindsTheFirstFrameFromASample) {
  const FrameClock clock(1000.0, 30, 10'000, {.from_s = 2.0, .to_s = 3.0, .speed = 0.7});
  for (int sample = 2000; sample < 3000; ++sample) {
    const int frame = clock.FirstFrameFrom(sample);
    EXPECT_GE(clock.Sample(frame), sample);
    if (frame > 0) {
      EXPECT_LT(clock.Sample(frame - 1), sample);
    }
  }
  EXPECT_EQ(clock.FirstFrameFrom(0), 0);
  EXPECT_EQ(clock.FirstFrameFrom(9999), clock.FrameCount());
}

TEST(FrameClock, TenSecondsAreThreeHundredFrames) {
  EXPECT_EQ(FrameClock(1000.0, 30, 10'000).FrameCount(), 300);
}

}  // namespace
}  // namespace gauntlet::sim
