#include "sim/score/counted_ticks.h"

#include <gtest/gtest.h>

#include <string>

#include "sim/score/delay.h"
#include "sim/score/score.h"
#include "tests/score/signals.h"

namespace gauntlet::sim {
namespace {

constexpr int kTicks = 20000;
constexpr int kRecovery = 1000;

std::vector<std::pair<int, int>> Pairs(const CountedTicks& counted) {
  std::vector<std::pair<int, int>> pairs;
  for (const TickRange& range : counted) pairs.emplace_back(range.begin, range.end);
  return pairs;
}

using Expected = std::vector<std::pair<int, int>>;

TEST(CountedTicks, AreAllWithoutAMask) {
  EXPECT_EQ(Pairs(CountTicks({}, {true}, kRecovery, 50)), (Expected{{0, 50}}));
  EXPECT_TRUE(CountTicks({}, {true}, kRecovery, 0).empty());
}

TEST(CountedTicks, LeaveOutGapsAndRestartsWithTheTimeAfterThemAndStopsWithout) {
  const std::vector<MaskedStretch> masked{{MaskReason::kRestart, 0, 9000, 9000},
                                          {MaskReason::kGap, 0, 2000, 3000},
                                          {MaskReason::kClipped, 0, 6000, 6500},
                                          {MaskReason::kGap, 1, 0, 20000}};
  EXPECT_EQ(Pairs(CountTicks(masked, {true, false}, kRecovery, kTicks)),
            (Expected{{0, 2000}, {4000, 6000}, {6500, 9000}, {10000, 20000}}));
  EXPECT_TRUE(CountTicks(masked, {true, true}, kRecovery, kTicks).empty());
}

TEST(CountedTicks, OfStretchesThatOverlapOrReachTheEndsAreWhatNoneCovers) {
  const std::vector<MaskedStretch> masked{{MaskReason::kClipped, 0, 0, 10},
                                          {MaskReason::kClipped, 0, 5, 20},
                                          {MaskReason::kGap, 0, 40, 45}};
  EXPECT_EQ(Pairs(CountTicks(masked, {true}, 100, 50)), (Expected{{20, 40}}));
  EXPECT_EQ(CountOf(CountTicks(masked, {true}, 0, 50)), 25);
}

/// A wearer whose second joint moves, rests and moves, a late hand that trembles, a motor and a
/// cable.
struct Trial {
  Signal reference = Signal::Zero(kTicks, 2);
  Signal hand = Signal::Zero(kTicks, 2);
  Signal twin = Signal::Zero(kTicks, 2);
  IntegerSignal command = IntegerSignal::Zero(kTicks, 1);
  Signal speed = Signal::Zero(kTicks, 1);
  Signal tension = Signal::Zero(kTicks, 1);
  Signal force = Signal::Zero(kTicks, 1);
  const ScoreRows rows{std::vector<std::string>{"a", "b"}, std::vector<std::string>{"m"},
                       std::vector<std::string>{"c"}};

  Trial() {
    const std::vector<double> noise = Noise(kTicks, 5);
    for (int n = 0; n < kTicks; ++n) {
      reference(n, 0) = At(n, 0.7);
      reference(n, 1) = n % 6000 < 3000 ? 0.5 : At(n, 0.5);
      for (int c = 0; c < 2; ++c) {
        twin(n, c) = reference(std::max(0, n - 60), c) + 0.01;
        hand(n, c) = twin(n, c) + 0.004 * noise[n];
      }
      command(n, 0) = static_cast<int>(20.0 * noise[n / 20 * 20]);
      speed(n, 0) = std::cos(0.4 * n) + noise[n];
      tension(n, 0) = std::max(0.0, noise[n]);
      force(n, 0) = 3.0 + 0.2 * noise[n];
    }
  }
  static double At(int n, double hz) { return 0.5 * std::sin(2.0 * kPi * hz * n / 1000.0); }

  Scores Score(const CountedParts* counted) const {
    ScoreInput input{.reference_angle_rad = &reference,
                     .hand_angle_rad = &hand,
                     .command_counts = &command,
                     .motor_speed_rad_s = &speed,
                     .tension_n = &tension,
                     .grip_force_n = &force};
    input.counted = counted;
    input.noise_free_hand_angle_rad = &twin;
    input.without = {&twin, &twin, &twin, &twin, &twin, &twin, &twin, &twin, &reference};
    return ComputeScores(input, rows);
  }
  /// Whatever a gap holds, nobody may see it.
  void Spoil(const TickRange& range) {
    for (int n = range.begin; n < range.end; ++n) {
      reference.row(n).setConstant(0.3 + 0.2 * (n % 7));
      hand.row(n).setConstant(-1.0 - 0.1 * (n % 5));
      twin.row(n).setConstant(2.0);
      command(n, 0) = n % 3 * 100;
      speed(n, 0) = 50.0 * (n % 2);
      tension(n, 0) = 500.0;
      force(n, 0) = n % 4;
    }
  }
};

CountedParts Everywhere(const CountedTicks& counted) {
  return {.joints = {counted, counted}, .motors = {counted}, .cables = {counted}, .hand = counted};
}

bool IsPartOfError(std::size_t metric) {
  return std::ranges::find(TrackingErrorParts(), metric, &CauseMetric::metric) !=
         TrackingErrorParts().end();
}

TEST(CountedTicks, OfAllTicksGiveTheScoresOfNoMaskToTheLastBit) {
  const Trial trial;
  const CountedParts all = Everywhere({{0, kTicks}});
  const Scores with = trial.Score(&all);
  const Scores without = trial.Score(nullptr);
  for (std::size_t m = 0; m < Metrics().size(); ++m) {
    const bool none = std::isnan(without.summary[m]);
    EXPECT_TRUE(none ? std::isnan(with.summary[m]) : with.summary[m] == without.summary[m])
        << Metrics()[m].key;
  }
}

TEST(CountedTicks, HideWhatIsNotCountedFromEveryScore) {
  const std::vector<MaskedStretch> masked{{MaskReason::kGap, 0, 7000, 8000}};
  const CountedParts counted = Everywhere(CountTicks(masked, {true}, kRecovery, kTicks));
  Trial trial;
  const Scores before = trial.Score(&counted);
  trial.Spoil({7000, 8000});
  const Scores after = trial.Score(&counted);
  int compared = 0;
  for (std::size_t m = 0; m < Metrics().size(); ++m) {
    // The parts of the error are of a fit over all: only their sum is of what counts.
    if (std::isnan(before.summary[m]) || IsPartOfError(m)) continue;
    EXPECT_NEAR(after.summary[m], before.summary[m], 1e-9 * std::abs(before.summary[m]))
        << Metrics()[m].key;
    ++compared;
  }
  EXPECT_GT(compared, 20);
  const std::size_t rmse = MetricIndex("tracking_rmse_deg");
  double sum = 0.0;
  for (const CauseMetric& part : TrackingErrorParts()) {
    sum += after.channels[1][part.metric];
  }
  EXPECT_NEAR(sum, after.channels[1][rmse] * after.channels[1][rmse], 1e-9);
}

TEST(CountedTicks, OfNothingHaveNoScores) {
  const Trial trial;
  const CountedParts none = Everywhere({});
  for (const double score : trial.Score(&none).summary) EXPECT_TRUE(std::isnan(score));
}

TEST(CountedTicks, WithoutARangeKeepWhatIsBeforeAndBehind) {
  const CountedTicks counted = {{0, 10}, {20, 30}};
  const auto text_of = [](const CountedTicks& ticks) {
    std::string text;
    for (const TickRange& range : ticks) {
      text += std::to_string(range.begin) + "-" + std::to_string(range.end) + " ";
    }
    return text;
  };
  EXPECT_EQ(text_of(Without(counted, {5, 25})), "0-5 25-30 ");
  EXPECT_EQ(text_of(Without(counted, {2, 4})), "0-2 4-10 20-30 ");
  EXPECT_EQ(text_of(Without(counted, {10, 20})), "0-10 20-30 ");
  EXPECT_EQ(text_of(Without(counted, {0, 30})), "");
}

TEST(CountedTicks, InTwoRangesGiveTheDelayOfEach) {
  const auto leader = Sampled(20.0, 1000.0, [](double t) { return std::sin(2.0 * kPi * 0.6 * t); });
  auto follower =
      Sampled(20.0, 1000.0, [](double t) { return std::sin(2.0 * kPi * 0.6 * (t - 0.08)); });
  std::fill(follower.begin() + 9000, follower.begin() + 12000, 5.0);
  Fourier fourier;
  const auto delay =
      DelaySamples(leader, follower, 1000.0, 0.0, {{0, 9000}, {12000, 20000}}, fourier);
  ASSERT_TRUE(delay);
  EXPECT_NEAR(*delay, 80.0, 0.5);
  EXPECT_FALSE(DelaySamples(leader, follower, 1000.0, 0.0, {}, fourier));
}

}  // namespace
}  // namespace gauntlet::sim
