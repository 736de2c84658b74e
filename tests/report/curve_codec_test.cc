#include "sim/show/pages/curve_codec.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "tests/report/curve_decoder.h"

namespace gauntlet::sim {
namespace {

using test::DecodeCurve;

constexpr double kMissing = std::numeric_limits<double>::quiet_NaN();

std::vector<double> RoughCurve(int size) {
  std::vector<double> values;
  for (int i = 0; i < size; ++i) values.push_back(40.0 * std::sin(0.01 * i) + std::sin(977.0 * i));
  return values;
}

TEST(EncodeCurve, WritesTheBytesOfItsDescription) {
  // Base64 of the bytes 01, 00, 03, 02 and 81 01, by hand after RFC 4648.
  EXPECT_EQ(EncodeCurve(std::vector{0.0}, 1.0), "AQ==");
  EXPECT_EQ(EncodeCurve(std::vector{kMissing}, 1.0), "AA==");
  EXPECT_EQ(EncodeCurve(std::vector{1.0}, 1.0), "Aw==");
  EXPECT_EQ(EncodeCurve(std::vector{-1.0}, 1.0), "Ag==");
  EXPECT_EQ(EncodeCurve(std::vector{64.0}, 1.0), "gQE=");
  EXPECT_EQ(EncodeCurve(std::vector<double>{}, 1.0), "");
}

TEST(EncodeCurve, IsNeverMoreThanHalfAStepOff) {
  const std::vector<double> values = RoughCurve(5000);
  const std::vector<double> read = DecodeCurve(EncodeCurve(values, 0.005), 0.005);
  ASSERT_EQ(read.size(), values.size());
  for (std::size_t i = 0; i < values.size(); ++i) ASSERT_NEAR(read[i], values[i], 0.0025 + 1e-12);
}

TEST(EncodeCurve, KeepsGapsWithoutShiftingWhatFollows) {
  const std::vector<double> values{1.0, kMissing, std::numeric_limits<double>::infinity(), 2.0};
  const std::vector<double> read = DecodeCurve(EncodeCurve(values, 0.005), 0.005);
  ASSERT_EQ(read.size(), 4U);
  EXPECT_NEAR(read[0], 1.0, 1e-9);
  EXPECT_TRUE(std::isnan(read[1]));
  EXPECT_TRUE(std::isnan(read[2]));
  EXPECT_NEAR(read[3], 2.0, 1e-9);
}

TEST(EncodeCurve, SurvivesAnglesOfADivergedHand) {
  const std::vector<double> values{1e300, -1e300, 0.0};
  EXPECT_EQ(DecodeCurve(EncodeCurve(values, 0.005), 0.005).back(), 0.0);
}

TEST(KeepPeaks, LosesNoPeakOfOneSample) {
  for (const int spike : {0, 1, 499, 500, 777, 999}) {
    std::vector<double> values = RoughCurve(1000);
    values[static_cast<std::size_t>(spike)] = 500.0;
    const std::vector<double> points = KeepPeaks(values, 50);
    ASSERT_EQ(points.size(), 40U);
    EXPECT_EQ(std::max(points[2 * (spike / 50)], points[2 * (spike / 50) + 1]), 500.0);
  }
}

TEST(KeepPeaks, EveryBucketHasItsExtremesInTheOrderOfTime) {
  const std::vector<double> values = RoughCurve(1003);  // the last bucket is short
  const std::vector<double> points = KeepPeaks(values, 10);
  ASSERT_EQ(points.size(), 202U);
  for (std::size_t b = 0; b < 101; ++b) {
    const auto begin = values.begin() + static_cast<std::ptrdiff_t>(10 * b);
    const auto end =
        values.begin() + static_cast<std::ptrdiff_t>(std::min<std::size_t>(10 * b + 10, 1003));
    const auto [low, high] = std::minmax_element(begin, end);
    const bool low_first = low <= high;
    ASSERT_EQ(points[2 * b], low_first ? *low : *high);
    ASSERT_EQ(points[2 * b + 1], low_first ? *high : *low);
  }
}

TEST(KeepPeaks, PassesOverMissingValues) {
  const std::vector<double> values{kMissing, 3.0, 1.0, kMissing, kMissing, kMissing};
  const std::vector<double> points = KeepPeaks(values, 3);
  ASSERT_EQ(points.size(), 4U);
  EXPECT_EQ(points[0], 3.0);
  EXPECT_EQ(points[1], 1.0);
  EXPECT_TRUE(std::isnan(points[2]));
  EXPECT_TRUE(std::isnan(points[3]));
}

TEST(SamplesPerBucket, KeepsEverySampleOfAShortRecording) {
  EXPECT_EQ(SamplesPerBucket(10'000, 18 * (2 + 3 * 5)), 1);
}

TEST(SamplesPerBucket, NeverGivesMorePointsThanAPageMayHave) {
  for (const std::int64_t samples : {1'000, 60'000, 94'096, 3'600'000}) {
    for (const std::int64_t curves : {20, 90, 252, 900}) {
      const std::int64_t bucket = SamplesPerBucket(samples, curves);
      const std::int64_t points = bucket == 1 ? samples * curves : 2 * (samples / bucket) * curves;
      EXPECT_LE(points, kCurvePoints) << samples << " x " << curves;
      // ... nor needlessly few: two points for one or two samples would be no gain.
      EXPECT_NE(bucket, 2);
      if (bucket > 3) {
        EXPECT_GT(2 * samples * curves, kCurvePoints * (bucket - 1));
      }
    }
  }
}

}  // namespace
}  // namespace gauntlet::sim
