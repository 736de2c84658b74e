// Two senders in one stream are found by clocks and levels; streams of one sender are not.
#include "sim/recordings/inspect/senders.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <random>
#include <utility>
#include <vector>

namespace gauntlet::sim {
namespace {

constexpr double kPeriod_s = 0.02;
constexpr int kSamples = 400;
constexpr std::size_t kSensors = 3;
constexpr std::size_t kClock = kSensors;  // column

struct Row {
  double time_s = 0.0;
  std::vector<double> values;
};

/// Sensors of a hand that moves at 0.2 Hz, with noise. `phase`: hands move differently.
Row HandAt(double time_s, double phase = 0.0) {
  static std::mt19937 generator(1);
  std::normal_distribution<double> noise(0.0, 2.0);
  Row row{.time_s = time_s, .values = {}};
  for (std::size_t i = 0; i < kSensors; ++i) {
    row.values.push_back(500.0 + 200.0 * std::sin(1.3 * time_s + phase + static_cast<double>(i)) +
                         noise(generator));
  }
  return row;
}

std::optional<Senders> SendersIn(const std::vector<Row>& rows, bool has_time = true) {
  SenderWatch watch(kSensors + 1);
  for (const Row& row : rows) {
    std::vector<double> values = row.values;
    values.push_back(row.time_s);
    watch.Add(has_time ? row.time_s : std::nan(""), values);
  }
  const std::vector<std::pair<std::size_t, double>> sensors = {{0, 400.0}, {1, 400.0}, {2, 400.0}};
  return watch.Find(kClock, sensors);
}

std::vector<Row> OneHand() {
  std::vector<Row> rows;
  for (int k = 0; k < kSamples; ++k) rows.push_back(HandAt(k * kPeriod_s));
  return rows;
}

TEST(Senders, AClockThatGoesBackEverySecondRowIsOfTwo) {
  std::vector<Row> rows;
  for (int k = 0; k < kSamples; ++k) {
    rows.push_back(HandAt(k * kPeriod_s));
    rows.push_back(HandAt(k * kPeriod_s - 0.045));  // the same hand, so levels do not tell
  }
  const auto found = SendersIn(rows);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->column, kClock);
  EXPECT_EQ(found->every, 2);
  EXPECT_NEAR(found->older_s, 0.045, 1e-9);
  EXPECT_EQ(TextOf(*found), "two senders: every 2nd row is 0.045 s older; record one of them");
}

TEST(Senders, TheSlowerSenderHasEveryThirdRow) {
  for (const double older_s : {100.0, -100.0}) {
    std::vector<Row> rows;
    for (int k = 0; k < kSamples; ++k) {
      rows.push_back(HandAt(k * kPeriod_s));
      rows.push_back(HandAt((k + 0.5) * kPeriod_s));
      rows.push_back(HandAt((k + 0.5) * kPeriod_s - older_s));
    }
    const auto found = SendersIn(rows);
    ASSERT_TRUE(found) << older_s;
    EXPECT_EQ(found->every, 3);
    EXPECT_NEAR(found->older_s, older_s, 1e-6);
  }
}

TEST(Senders, SomeRowsMayChangePlaces) {
  std::vector<Row> rows;
  for (int k = 0; k < kSamples; ++k) {
    const bool is_changed = k % 20 == 7;
    for (const bool is_second : {is_changed, !is_changed}) {
      rows.push_back(HandAt(k * kPeriod_s - (is_second ? 3.2 : 0.0), is_second ? 2.0 : 0.0));
    }
  }
  const auto found = SendersIn(rows);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->every, 2);
  EXPECT_NEAR(found->older_s, 3.2, 0.01);
}

TEST(Senders, TwoLevelsAreOfTwoThoughTheClockRises) {
  std::vector<Row> rows;
  for (int k = 0; k < 2 * kSamples; ++k) {
    rows.push_back(HandAt(0.5 * k * kPeriod_s, k % 2 == 0 ? 0.0 : 2.0));
  }
  for (const bool has_time : {true, false}) {
    const auto found = SendersIn(rows, has_time);
    ASSERT_TRUE(found);
    EXPECT_EQ(found->column, 0U);
    EXPECT_EQ(TextOf(*found),
              "two senders: every 2nd row has another level in 3 sensors; record one of them");
  }
}

TEST(Senders, OneSenderIsNotTwo) {
  EXPECT_FALSE(SendersIn(OneHand()));
  EXPECT_FALSE(SendersIn(OneHand(), false));
}

TEST(Senders, RowsInDisorderAreOfOneSender) {
  std::vector<Row> changed = OneHand();
  for (std::size_t k = 0; k + 1 < changed.size(); k += 2) std::swap(changed[k], changed[k + 1]);
  EXPECT_FALSE(SendersIn(changed));

  std::vector<Row> reversed = OneHand();
  for (std::size_t k = 0; k + 2 < reversed.size(); k += 3) std::swap(reversed[k], reversed[k + 2]);
  EXPECT_FALSE(SendersIn(reversed));

  std::mt19937 generator(2);
  for (const double jitter_s : {0.01, 0.02, 0.05}) {
    std::vector<Row> late = OneHand();
    std::normal_distribution<double> jitter(0.0, jitter_s);
    for (Row& row : late) row.time_s += jitter(generator);
    EXPECT_FALSE(SendersIn(late)) << jitter_s;
  }
}

TEST(Senders, AClockThatStartsAnewOrRepeatsIsOfOneSender) {
  std::vector<Row> sessions, bursts, halves = OneHand();
  for (int session = 0; session < 20; ++session) {
    for (int k = 0; k < 20; ++k) sessions.push_back(HandAt(k * kPeriod_s));
  }
  EXPECT_FALSE(SendersIn(sessions));
  for (int k = 0; k < kSamples; ++k) bursts.push_back(HandAt(k / 4 * 4 * kPeriod_s));
  EXPECT_FALSE(SendersIn(bursts));
  // Nanoseconds of a clock at 2 Hz, without its seconds.
  for (std::size_t k = 0; k < halves.size(); ++k) halves[k].time_s = k % 2 == 0 ? 0.0 : 0.5;
  EXPECT_FALSE(SendersIn(halves));
}

TEST(Senders, HumAndNoiseAreNoLevels) {
  std::vector<Row> hum = OneHand(), noise = OneHand(), fast = OneHand(), one_sensor = OneHand();
  std::mt19937 generator(3);
  std::normal_distribution<double> wide(500.0, 100.0);
  for (std::size_t k = 0; k < hum.size(); ++k) {
    for (std::size_t i = 0; i < kSensors; ++i) {
      hum[k].values[i] += k % 2 == 0 ? 30.0 : -30.0;
      noise[k].values[i] = wide(generator);
      fast[k].values[i] = 500.0 + 200.0 * std::sin(2.2 * static_cast<double>(k + i));
    }
    one_sensor[k].values[1] = k % 2 == 0 ? 300.0 : 700.0;
  }
  EXPECT_FALSE(SendersIn(hum));
  EXPECT_FALSE(SendersIn(noise));
  EXPECT_FALSE(SendersIn(fast));
  EXPECT_FALSE(SendersIn(one_sensor));
}

}  // namespace
}  // namespace gauntlet::sim
