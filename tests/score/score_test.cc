#include "sim/score/score.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <stdexcept>

#include "tests/score/signals.h"

namespace gauntlet::sim {
namespace {

std::size_t IndexOf(std::string_view key) {
  const auto metrics = Metrics();
  const auto at = std::find_if(metrics.begin(), metrics.end(),
                               [&](const Metric& metric) { return metric.key == key; });
  EXPECT_NE(at, metrics.end()) << key;
  return at - metrics.begin();
}

/// A wearer of two channels that moves and one that does not; a hand that is 37 ms late.
struct Example {
  Signal reference = Signal::Zero(12000, 3);
  Signal hand = Signal::Zero(12000, 3);
  IntegerSignal command = IntegerSignal::Zero(12000, 3);

  Example() {
    for (int n = 0; n < 12000; ++n) {
      reference(n, 0) = At(n, 0.5);
      reference(n, 1) = At(n, 0.9);
      hand(n, 0) = At(n - 37, 0.5);
      hand(n, 1) = At(n - 37, 0.9) + 2.0 * kRadPerDeg;
      hand(n, 2) = 0.5 * kRadPerDeg * std::sqrt(2.0) * std::sin(2.0 * kPi * 12.0 * n / 1000.0);
      command(n, 2) = n / 100 % 2;
    }
  }
  static double At(int n, double hz) { return 0.5 * std::sin(2.0 * kPi * hz * n / 1000.0); }
  ScoreInput Input() const {
    return {.reference_angle_rad = &reference, .hand_angle_rad = &hand, .command_counts = &command};
  }
};

TEST(Metrics, HaveDistinctKeysWithUnitsAndWords) {
  std::set<std::string_view> keys;
  for (const Metric& metric : Metrics()) {
    EXPECT_TRUE(keys.insert(metric.key).second) << metric.key;
    EXPECT_FALSE(metric.help.empty());
    EXPECT_FALSE(metric.definition.empty());
  }
}

TEST(Scores, OfAKnownHandAreTheKnownValues) {
  const Example example;
  const Scores scores = ComputeScores(example.Input());
  ASSERT_EQ(scores.channels.size(), 3u);
  EXPECT_NEAR(scores.channels[0][IndexOf("delay_ms")], 37.0, 0.2);
  EXPECT_NEAR(scores.summary[IndexOf("delay_ms")], 37.0, 0.2);
  EXPECT_NEAR(scores.channels[0][IndexOf("aligned_rmse_deg")], 0.0, 0.01);
  EXPECT_NEAR(scores.channels[1][IndexOf("aligned_rmse_deg")], 2.0, 0.01);
  EXPECT_NEAR(scores.channels[2][IndexOf("jitter_rms_deg")], 0.50, 0.01);
  EXPECT_NEAR(scores.summary[IndexOf("jitter_rms_deg")], 0.50 / 3.0, 0.01);
  EXPECT_NEAR(scores.channels[2][IndexOf("peak_error_deg")], 0.5 * std::sqrt(2.0), 1e-3);
  // |sin(t) - sin(t - d)| has the RMS sqrt(2) sin(omega d / 2) amplitude.
  EXPECT_NEAR(scores.channels[0][IndexOf("tracking_rmse_deg")],
              0.5 * kDegPerRad * std::sqrt(2.0) * std::sin(kPi * 0.5 * 0.037), 0.01);
  EXPECT_NEAR(scores.channels[2][IndexOf("command_reversals_per_s")], 118.0 / 12.0, 1e-9);
}

TEST(Scores, OfAChannelThatNeverMovesHaveNoDelayAndKeepTheRest) {
  const Example example;
  const Scores scores = ComputeScores(example.Input());
  EXPECT_TRUE(std::isnan(scores.channels[2][IndexOf("delay_ms")]));
  EXPECT_EQ(scores.channels[2][IndexOf("aligned_rmse_deg")],
            scores.channels[2][IndexOf("tracking_rmse_deg")]);
}

TEST(Scores, WithoutTheirSignalDoNotExist) {
  const Example example;
  ScoreInput input = example.Input();
  input.command_counts = nullptr;
  EXPECT_TRUE(std::isnan(ComputeScores(input).summary[IndexOf("command_reversals_per_s")]));
}

TEST(Scores, OfAHandStoppedEarlyAreThoseOfItsRows) {
  const Example example;
  ScoreInput input = example.Input();
  const Signal hand = example.hand.topRows(7000);
  const Signal reference = example.reference.topRows(7000);
  input.hand_angle_rad = &hand;
  const Scores longer = ComputeScores(input);
  input.reference_angle_rad = &reference;
  EXPECT_EQ(longer.summary, ComputeScores(input).summary);
  const Signal nothing(0, 3);
  input.hand_angle_rad = &nothing;
  for (const double value : ComputeScores(input).summary) EXPECT_TRUE(std::isnan(value));
}

TEST(Scores, AreTheSameEveryTime) {
  const Example example;
  const Scores first = ComputeScores(example.Input());
  const Scores second = ComputeScores(example.Input());
  for (std::size_t c = 0; c < 2; ++c) EXPECT_EQ(first.channels[c], second.channels[c]);
}

TEST(Scores, RefuseSignalsThatDoNotFit) {
  const Example example;
  ScoreInput input = example.Input();
  const Signal narrow = example.hand.leftCols(2);
  input.hand_angle_rad = &narrow;
  EXPECT_THROW(ComputeScores(input), std::invalid_argument);
  input.hand_angle_rad = nullptr;
  EXPECT_THROW(ComputeScores(input), std::invalid_argument);
}

}  // namespace
}  // namespace gauntlet::sim
