#include "sim/live/frame_arrivals.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

namespace gauntlet::sim {
namespace {

/// Frames 1 ms apart with these numbers, each with values of its own.
std::vector<std::int64_t> Numbers(FrameArrivals& arrivals, const std::vector<std::int64_t>& numbers,
                                  std::int64_t first_ms = 0) {
  std::vector<std::int64_t> given;
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    const std::array values = {static_cast<double>(first_ms) + static_cast<double>(i)};
    const std::int64_t arrival_ms = first_ms + static_cast<std::int64_t>(i);
    given.push_back(
        arrivals.Add({.arrival_ns = 1'000'000 * arrival_ms, .number = numbers[i], .values = values})
            .number);
  }
  return given;
}

TEST(FrameArrivals, CountsLostRepeatedAndReorderedFrames) {
  FrameArrivals arrivals;
  EXPECT_EQ(Numbers(arrivals, {7, 8, 11, 11, 10, 12, 15}),
            (std::vector<std::int64_t>{0, 1, 4, 4, 3, 5, 8}));
  const ArrivalFacts facts = arrivals.Facts();
  EXPECT_EQ(facts.frames, 7);
  EXPECT_EQ(facts.repeated, 1);
  EXPECT_EQ(facts.out_of_order, 1);
  EXPECT_EQ(facts.lost, 3);  // 9, 13, 14; 10 came after all
  EXPECT_EQ(facts.longest_loss, 2);
  EXPECT_EQ(facts.restarts, 0);
}

TEST(FrameArrivals, HaveTheRateOfTheDeviceWithoutSilencesAndWithoutWhatWaited) {
  for (const bool has_numbers : {false, true}) {
    for (const bool was_link : {false, true}) {  // whose losses have numbers
      FrameArrivals arrivals;
      std::int64_t number = 0;
      const auto add = [&](double time_s) {
        const std::array values = {time_s};
        arrivals.Add({.arrival_ns = static_cast<std::int64_t>(1e9 * time_s),
                      .number = has_numbers ? std::optional(number) : std::nullopt,
                      .values = values});
        ++number;
      };
      for (int i = 0; i < 97; ++i) add(1.0 + 1e-5 * i);
      arrivals.BeginRate();
      for (int i = 0; i < 300; ++i) add(1.5 + i / 98.0);
      if (was_link) number += 98;
      for (int i = 0; i < 300; ++i) add(1.5 + 299 / 98.0 + 1.03 + i / 98.0);
      EXPECT_NEAR(arrivals.Facts().Rate_hz(), 98.0, 0.01) << has_numbers << was_link;
      EXPECT_EQ(arrivals.Facts().frames, 697);
    }
  }
}

TEST(FrameArrivals, GoesOnBehindTheLastNumberWhenTheSenderStartsAnew) {
  FrameArrivals arrivals;
  Numbers(arrivals, {100, 101, 102});
  const std::vector<std::int64_t> given = Numbers(arrivals, {0, 1, 2, 3, 4, 5, 6}, 200);
  EXPECT_EQ(given.back(), 5);
  EXPECT_EQ(arrivals.Facts().restarts, 1);
}

TEST(FrameArrivals, TakesABurstOfLateFramesForNoRestart) {
  FrameArrivals arrivals;
  std::vector<std::int64_t> numbers;
  for (int i = 0; i < 20; ++i) numbers.push_back(i);
  for (int i = 40; i < 60; ++i) numbers.push_back(i);
  for (int i = 20; i < 40; ++i) numbers.push_back(i);
  numbers.push_back(60);
  EXPECT_EQ(Numbers(arrivals, numbers).back(), 60);
  EXPECT_EQ(arrivals.Facts().restarts, 0);
  EXPECT_EQ(arrivals.Facts().lost, 0);
  EXPECT_EQ(arrivals.Facts().out_of_order, 20);
}

TEST(FrameArrivals, SurvivesNumbersThatNoSenderCounts) {
  FrameArrivals arrivals;
  Numbers(arrivals, {5, 6, std::numeric_limits<std::int64_t>::max(),
                     std::numeric_limits<std::int64_t>::min(), 7});
  const std::vector<std::int64_t> given = Numbers(arrivals, {8, 9, 10, 11, 12, 13, 14}, 100);
  EXPECT_LT(given.back(), 100);
  EXPECT_EQ(given.back(), given[given.size() - 2] + 1);
  EXPECT_LT(arrivals.Facts().lost, 1000);
}

TEST(FrameArrivals, TakeANumberAMillionAheadForAnother) {
  for (const std::int64_t ahead : {1'000'000, 1'000'001}) {
    FrameArrivals arrivals;
    const std::vector<std::int64_t> given = Numbers(arrivals, {5, 5 + ahead});
    const bool is_other = ahead > 1'000'000;
    EXPECT_EQ(given[1], is_other ? 1 : ahead);
    EXPECT_EQ(arrivals.Facts().restarts, is_other ? 1 : 0);
    EXPECT_EQ(arrivals.Facts().lost, is_other ? 0 : ahead - 1);
  }
}

/// The fifth of rising numbers, later than 50 ms behind the newest one.
TEST(FrameArrivals, KnowASenderThatStartedAnewByFiveRisingNumbers) {
  struct Case {
    std::int64_t first_ms;
    std::vector<std::int64_t> numbers;
    bool is_new;
  };
  for (const Case& is : {Case{47, {0, 1, 2, 3, 4}, true},
                         {46, {0, 1, 2, 3, 4}, false},
                         {90, {0, 1, 2, 3}, false},
                         {90, {0, 1, 1, 2, 3}, false},
                         {90, {3, 0, 1, 2, 3, 4}, true}}) {
    FrameArrivals arrivals;
    Numbers(arrivals, {100, 101});  // the newest at 1 ms
    const std::vector<std::int64_t> given = Numbers(arrivals, is.numbers, is.first_ms + 1);
    EXPECT_EQ(arrivals.Facts().restarts, is.is_new ? 1 : 0) << is.first_ms;
    EXPECT_EQ(given.back(), is.is_new ? 2 : is.numbers.back() - 100) << is.first_ms;
  }
}

/// A quarter of a second, and more than ten usual gaps, behind ten frames at least.
TEST(FrameArrivals, KnowASilenceByItsLength) {
  struct Case {
    int frames;
    double usual_ms;
    double gap_ms;
    bool is_silence;
  };
  for (const Case& is : {Case{10, 10.0, 249.0, false},
                         {10, 10.0, 250.0, true},
                         {9, 10.0, 400.0, false},
                         {10, 30.0, 300.0, false},
                         {10, 30.0, 301.0, true}}) {
    FrameArrivals arrivals;
    double time_ms = 0.0;
    for (int i = 0; i <= is.frames; ++i) {
      const std::array values = {time_ms};
      arrivals.Add({.arrival_ns = std::llround(1e6 * time_ms), .values = values});
      time_ms += i + 1 < is.frames ? is.usual_ms : is.gap_ms;
    }
    const ArrivalFacts facts = arrivals.Facts();
    EXPECT_EQ(facts.silences, is.is_silence ? 1 : 0) << is.gap_ms;
    EXPECT_EQ(facts.silence_ns, is.is_silence ? std::llround(1e6 * is.gap_ms) : 0);
    EXPECT_EQ(facts.lost_in_silences, 0);
  }
}

TEST(FrameArrivals, HaveTheLengthOf99PercentOfTheLosses) {
  for (const int long_ones : {0, 1, 2}) {
    FrameArrivals arrivals;
    std::vector<std::int64_t> numbers = {0};
    for (int i = 0; i < 100; ++i) numbers.push_back(numbers.back() + (i < long_ones ? 6 : 2));
    Numbers(arrivals, numbers);
    EXPECT_EQ(arrivals.Facts().p99_loss, long_ones < 2 ? 1 : 5);
    EXPECT_EQ(arrivals.Facts().longest_loss, long_ones == 0 ? 1 : 5);
  }
}

TEST(FrameArrivals, HaveNoRateOfOneFrame) {
  FrameArrivals arrivals;
  Numbers(arrivals, {0});
  EXPECT_TRUE(std::isnan(arrivals.Facts().PerSecond(1)));
  EXPECT_TRUE(std::isnan(arrivals.Facts().Rate_hz()));
  Numbers(arrivals, {1}, 10);
  EXPECT_DOUBLE_EQ(arrivals.Facts().PerSecond(2), 100.0);
  EXPECT_DOUBLE_EQ(arrivals.Facts().PerSecond(1), 0.0);
  EXPECT_DOUBLE_EQ(arrivals.Facts().Rate_hz(), 100.0);
}

TEST(FrameArrivals, MeasuresTheDelayAboveTheFastestFrameWithoutACommonClock) {
  FrameArrivals arrivals;
  const std::array values = {1.0};
  for (const std::int64_t delay_ms : {5, 3, 9}) {
    arrivals.Add({.arrival_ns = 1'000'000 * (1000 + delay_ms),
                  .sender_time_ns = -77'000'000'000,
                  .values = values});
  }
  const ArrivalFacts facts = arrivals.Facts();
  EXPECT_NEAR(facts.relative_delay.max_us(), 6000.0, 1.0);
  EXPECT_EQ(facts.different, 1);
  EXPECT_FALSE(facts.has_numbers);
}

}  // namespace
}  // namespace gauntlet::sim
