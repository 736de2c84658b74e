#include "sim/show/video/curve_plot.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "sim/base/signal.h"

namespace gauntlet::sim {
namespace {

constexpr Color kBlack = Rgb(0x000000);
constexpr std::uint32_t kWhite = 0xffffffffu;
constexpr AngleScale kScale = {.low_deg = 0.0, .high_deg = 100.0, .tick_deg = 1000.0};
// 240 px at 30 frames/s: 2 px a frame, 60 px a second, so 4 s fill it. 1 deg is 1 px.
constexpr Rect kArea = {10.0, 10.0, 240.0, 100.0};

Image DrawCurve(const std::vector<double>& angle_deg, int frame, double rate_hz = 1000.0,
                const Excerpt& excerpt = {}) {
  std::vector<double> angle_rad;
  for (double angle : angle_deg) angle_rad.push_back(kRadPerDeg * angle);
  Image image(260, 140);
  image.pixels.assign(image.pixels.size(), kWhite);
  const std::unique_ptr<Painter> opened = OpenPainter(image);
  Painter& painter = *opened;
  const FrameClock clock(rate_hz, 30, static_cast<std::int64_t>(angle_deg.size()), excerpt);
  const CurvePlot plot(kArea, 1.0, kScale, clock);
  const Curve curves[] = {{angle_rad, kBlack, 1.0, false}};
  plot.Draw(painter, frame, curves);
  return image;
}

/// The height of the darkest pixel of a column, as an angle; NaN where nothing is drawn.
double AngleAt(const Image& image, int x) {
  int darkest = -1;
  std::uint32_t value = 160;  // lines of the grid are lighter
  for (int y = 8; y < 112; ++y) {
    if ((image.Row(y)[x] & 255) < value) {
      value = image.Row(y)[x] & 255;
      darkest = y;
    }
  }
  return darkest < 0 ? NAN : kArea.bottom() - darkest - 0.5;
}

TEST(CurvePlot, DrawsAnglesAtTheirTimes) {
  std::vector<double> ramp;
  for (int i = 0; i < 3000; ++i) ramp.push_back(20.0 + 20.0 * i / 1000.0);  // 20 deg/s
  const Image image = DrawCurve(ramp, 60);                                  // at 2 s
  for (int px : {6, 30, 60, 90, 117}) {
    EXPECT_NEAR(AngleAt(image, 10 + px), 20.0 + 20.0 * px / 60.0, 1.0) << px;
  }
  EXPECT_TRUE(std::isnan(AngleAt(image, 10 + 124))) << "the future is not drawn";
}

// 2 px a frame as ever, so a quarter of the speed is four times as wide.
TEST(CurvePlot, SlowMotionBeginsAtItsOwnTime) {
  std::vector<double> ramp;
  for (int i = 0; i < 3000; ++i) ramp.push_back(30.0 * i / 1000.0);  // 30 deg/s
  const Image image = DrawCurve(ramp, 100, 1000.0, {.from_s = 1.0, .to_s = 2.0, .speed = 0.25});
  for (int px : {6, 60, 120, 190}) {
    EXPECT_NEAR(AngleAt(image, 10 + px), 30.0 + 30.0 * px / 240.0, 1.0) << px;
  }
}

TEST(CurvePlot, ScrollsWhenTheWindowIsFull) {
  std::vector<double> ramp;
  for (int i = 0; i < 10000; ++i) ramp.push_back(10.0 * i / 1000.0);
  const Image image = DrawCurve(ramp, 240);  // at 8 s, which is 5 px left of the right edge
  EXPECT_NEAR(AngleAt(image, 10 + 235 - 1), 80.0, 1.0);
  EXPECT_NEAR(AngleAt(image, 10 + 235 - 120), 60.0, 1.0);
  EXPECT_NEAR(AngleAt(image, 10 + 235 - 180), 50.0, 1.0);
}

TEST(CurvePlot, ScrollingMovesWholePixelsAndNothingElse) {
  std::vector<double> noise;
  std::uint32_t state = 1;
  for (int i = 0; i < 10000; ++i) {
    state = state * 1664525u + 1013904223u;
    noise.push_back(20.0 + 60.0 * (state >> 8) / 0x1p24);
  }
  const Image before = DrawCurve(noise, 200), after = DrawCurve(noise, 201);
  for (int y = 10; y < 110; ++y) {
    for (int px = 4; px < 230; ++px) {  // away from both ends
      ASSERT_EQ(before.Row(y)[10 + px], after.Row(y)[10 + px - 2]) << px << " " << y;
    }
  }
}

TEST(CurvePlot, ShowsASpikeOfOneSample) {
  std::vector<double> still(3000, 30.0);
  still[1007] = 90.0;
  const Image image = DrawCurve(still, 80);
  double highest = 0.0;
  for (int y = 12; y < 100; ++y) {
    for (int x = 68; x < 73; ++x) {
      if ((image.Row(y)[x] & 255) < 140) highest = std::max(highest, kArea.bottom() - y);
    }
  }
  EXPECT_GT(highest, 80.0);
}

TEST(CurvePlot, FillsDownToZero) {
  const std::vector<double> angle_rad(3000, kRadPerDeg * 50.0);
  Image image(260, 140);
  image.pixels.assign(image.pixels.size(), kWhite);
  const std::unique_ptr<Painter> opened = OpenPainter(image);
  Painter& painter = *opened;
  const CurvePlot plot(kArea, 1.0, kScale, FrameClock(1000.0, 30, 3000, {}));
  const Curve curves[] = {{.angle_rad = angle_rad, .color = kBlack, .filled = true}};
  plot.Draw(painter, 60, curves);
  const auto brightness = [&](double angle_deg) {
    return image.Row(static_cast<int>(kArea.bottom() - angle_deg))[10 + 50] & 255;
  };
  EXPECT_EQ(brightness(60.0), 255u);
  EXPECT_LT(brightness(50.0), 64u);
  for (const double inside_deg : {40.0, 20.0, 2.0}) EXPECT_NEAR(brightness(inside_deg), 178, 2);
}

TEST(CurvePlot, LeavesAGapWhereValuesAreMissing) {
  std::vector<double> angle_deg(3000, 30.0);
  for (int i = 1000; i < 1500; ++i) angle_deg[i] = NAN;
  const Image image = DrawCurve(angle_deg, 80);
  EXPECT_NEAR(AngleAt(image, 10 + 50), 30.0, 1.0);
  EXPECT_TRUE(std::isnan(AngleAt(image, 10 + 75)));
  EXPECT_NEAR(AngleAt(image, 10 + 100), 30.0, 1.0);
}

TEST(CurvePlot, WorksAtRatesBelowOneSamplePerPixel) {
  std::vector<double> ramp;
  for (int i = 0; i < 90; ++i) ramp.push_back(i);
  const Image image = DrawCurve(ramp, 60, 30.0);
  EXPECT_NEAR(AngleAt(image, 10 + 61), 30.5, 1.0);
}

TEST(ChooseAngleScale, ShowsCurvesWholeAndNoiseMostly) {
  std::vector<double> curve = {0.1, 0.9}, noise(1000, 0.5);
  noise[17] = 3.0;
  const std::span<const double> whole[] = {curve}, noisy[] = {noise};
  const AngleScale scale = ChooseAngleScale(whole, noisy);
  EXPECT_LT(scale.low_deg, 0.1 * kDegPerRad);
  EXPECT_GT(scale.high_deg, 0.9 * kDegPerRad);
  EXPECT_LT(scale.high_deg, 1.2 * kDegPerRad) << "one outlier must not flatten everything";
}

TEST(ChooseAngleScale, HasAFewTicksForAnyRange) {
  for (double range_deg : {0.0, 0.5, 3.0, 11.0, 40.0, 90.0, 200.0}) {
    const std::vector<double> curve = {0.3, 0.3 + kRadPerDeg * range_deg};
    const std::span<const double> whole[] = {curve};
    const AngleScale scale = ChooseAngleScale(whole, {});
    const double ticks = (scale.high_deg - scale.low_deg) / scale.tick_deg;
    EXPECT_GE(ticks, 1.7) << range_deg;
    EXPECT_LE(ticks, 5.0) << range_deg;
  }
}

}  // namespace
}  // namespace gauntlet::sim
