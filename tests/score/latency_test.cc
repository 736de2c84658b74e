#include "sim/score/latency.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <stdexcept>

#include "tests/score/signals.h"

namespace gauntlet::sim {
namespace {

constexpr int kSamples = 20000;

/// Three joints, one of them still; known delays at every stage.
struct Chain {
  Signal wearer = Signal(kSamples, 3);
  Signal raw = Signal(kSamples, 3);
  Signal filtered = Signal(kSamples, 3);
  Signal target = Signal(kSamples, 3);
  Signal command = Signal::Zero(kSamples, 3);
  Signal hand = Signal(kSamples, 3);

  double look_ahead_s = 0.0;

  static double At(double ms, int channel) {
    if (channel == 2) return 0.2;
    const double t = ms / 1000.0 + 3.0 * channel;
    return 0.5 * std::sin(2.0 * kPi * 0.43 * t) + 0.2 * std::sin(2.0 * kPi * 1.21 * t + 1.0);
  }

  /// Sensor 3 ms, filter 25 ms, event delay 30 ms, servo and cables 41 ms; events and frames each
  /// 20 ms. A moving average of 51 samples is late by 25 ms. The target looks so far ahead.
  explicit Chain(double noise_rad, int ahead_ms = 0) : look_ahead_s(1e-3 * ahead_ms) {
    const auto noise = Noise(3 * kSamples, 31);
    for (int c = 0; c < 3; ++c) {
      double sum = 0.0;
      for (int n = 0; n < kSamples; ++n) {
        wearer(n, c) = At(n, c);
        raw(n, c) = At(n - 3, c) + noise_rad * noise[3 * n + c];
        sum += raw(n, c) - (n >= 51 ? raw(n - 51, c) : 0.0);
        filtered(n, c) = sum / std::min(n + 1, 51);
      }
    }
    for (int n = 0; n < kSamples; ++n) {
      target.row(n) = filtered.row(std::min(n + ahead_ms, kSamples - 1));
    }
    constexpr double kCountsPerRad = 500.0;
    for (int n = 30; n < kSamples; ++n) {
      const Eigen::RowVector3d counts = kCountsPerRad * target.row((n - 30) / 20 * 20);
      command.row(n) = counts.array().round().matrix() / kCountsPerRad;
    }
    for (int n = 0; n < kSamples; ++n) hand.row(n) = command.row(std::max(0, n - 41) / 20 * 20);
  }
  LatencyInput Input() const {
    return {.wearer_angle_rad = &wearer,
            .raw_angle_rad = &raw,
            .filtered_angle_rad = &filtered,
            .target_angle_rad = &target,
            .command_angle_rad = &command,
            .hand_angle_rad = &hand,
            .look_ahead_s = look_ahead_s,
            .earliest_delay_s = 0.03 - look_ahead_s};
  }
};

void ExpectKnownLatencies(const LatencyBudget& budget, double tolerance_ms, double ahead_ms = 0.0) {
  // A frame held for 20 samples is late by 9.5 on average; the servo's frames come at multiples of
  // 20 ms, 10 ms after the command that arrives 30 ms after its event.
  const double known_ms[] = {3.0, 25.0, 9.5, -ahead_ms, 30.0, 10.0, 41.0};
  ASSERT_EQ(budget.stages.size(), std::size(known_ms));
  double sum = 0.0;
  for (std::size_t i = 0; i < std::size(known_ms); ++i) {
    EXPECT_NEAR(budget.stages[i].mean_ms, known_ms[i], tolerance_ms) << budget.stages[i].key;
    sum += known_ms[i];
  }
  EXPECT_NEAR(budget.sum_ms, sum, 2.0 * tolerance_ms);
  EXPECT_NEAR(budget.total_ms, sum, 2.0 * tolerance_ms);
}

TEST(Latency, OfKnownStagesIsTheKnownDelay) {
  ExpectKnownLatencies(MeasureLatency(Chain(0.0).Input()), 0.3);
}

TEST(Latency, OfAPredictionIsBelowZero) {
  ExpectKnownLatencies(MeasureLatency(Chain(0.0, 60).Input()), 0.3, 60.0);
}

TEST(Latency, OfTheMotionIsNotThatOfTheNoise) {
  ExpectKnownLatencies(MeasureLatency(Chain(2.0 * kRadPerDeg).Input()), 0.6);
}

TEST(Latency, IsMeasuredWhereTicksCount) {
  Chain chain(0.0);
  constexpr int kGap = 8000, kGapTicks = 1500, kRecoveryTicks = 1000;
  chain.wearer.middleRows(kGap, kGapTicks).array() += 1.0;  // nobody knows what the wearer did
  chain.hand.middleRows(kGap, kGapTicks).setZero();
  const CountedTicks known = {{0, kGap}, {kGap + kGapTicks + kRecoveryTicks, kSamples}};
  const std::vector<CountedTicks> counted(3, known);
  LatencyInput input = chain.Input();
  EXPECT_GT(std::abs(MeasureLatency(input).total_ms - 118.5), 5.0);
  input.counted = &counted;
  ExpectKnownLatencies(MeasureLatency(input), 0.6);
  const std::vector<CountedTicks> nothing(3, CountedTicks{{100, 600}});
  input.counted = &nothing;  // shorter than the low pass
  EXPECT_TRUE(std::isnan(MeasureLatency(input).total_ms));
}

TEST(Latency, OfTheServosFrameDependsOnWhereFramesBegin) {
  const Chain chain(0.0);
  LatencyInput input = chain.Input();
  input.first_servo_frame = 30;  // just when commands arrive
  EXPECT_NEAR(MeasureLatency(input).stages[5].mean_ms, 0.0, 1e-6);
  input.first_servo_frame = 25;
  EXPECT_NEAR(MeasureLatency(input).stages[5].mean_ms, 15.0, 0.3);
  input.ticks_per_servo_frame = 0;
  EXPECT_NEAR(MeasureLatency(input).stages[5].mean_ms, 0.0, 1e-6);
}

TEST(Latency, OfAStillChannelDoesNotExistAndDoesNotCount) {
  const LatencyBudget budget = MeasureLatency(Chain(0.0).Input());
  for (const LatencyStage& stage : budget.stages) {
    ASSERT_EQ(stage.channel_ms.size(), 3u);
    EXPECT_TRUE(std::isnan(stage.channel_ms[2]));
    EXPECT_NEAR(stage.mean_ms, 0.5 * (stage.channel_ms[0] + stage.channel_ms[1]), 1e-12);
  }
}

TEST(Latency, OfASignalTooShortDoesNotExist) {
  const Chain chain(0.0);
  LatencyInput input = chain.Input();
  const Signal hand = chain.hand.topRows(500);
  input.hand_angle_rad = &hand;
  const LatencyBudget budget = MeasureLatency(input);
  EXPECT_TRUE(std::isnan(budget.total_ms));
  EXPECT_TRUE(std::isnan(budget.sum_ms));
}

TEST(Latency, OfAJointWhoseCommandIsNoAngleDoesNotExist) {
  Chain chain(0.0);
  chain.command.col(1).setConstant(std::numeric_limits<double>::quiet_NaN());  // springs decide it
  const LatencyBudget budget = MeasureLatency(chain.Input());
  EXPECT_TRUE(std::isnan(budget.stages[4].channel_ms[1]));
  EXPECT_NEAR(budget.stages[4].mean_ms, 30.0, 0.3);
}

TEST(Latency, RefusesSignalsThatDoNotFit) {
  const Chain chain(0.0);
  LatencyInput input = chain.Input();
  const Signal narrow = chain.command.leftCols(2);
  input.command_angle_rad = &narrow;
  EXPECT_THROW(MeasureLatency(input), std::invalid_argument);
  input = chain.Input();
  input.filtered_angle_rad = nullptr;
  EXPECT_THROW(MeasureLatency(input), std::invalid_argument);
  input = chain.Input();
  input.hand_angle_rad = nullptr;
  EXPECT_THROW(MeasureLatency(input), std::invalid_argument);
  for (const std::vector<CountedTicks>& counted :
       {std::vector<CountedTicks>(2), std::vector<CountedTicks>(3, {{0, kSamples + 1}})}) {
    input = chain.Input();
    input.counted = &counted;
    EXPECT_THROW(MeasureLatency(input), std::invalid_argument);
  }
}

}  // namespace
}  // namespace gauntlet::sim
