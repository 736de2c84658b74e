#include "sim/score/wearer.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "tests/score/signals.h"

namespace gauntlet::sim {
namespace {

constexpr double kRate_hz = 1000.0;

/// Rest of 2 s, a ramp of 1 s over 30 deg, rest of 2 s, a ramp back of 0.3 s, rest of 2 s.
double RampsAndRests_deg(double t) {
  return 30.0 * (std::clamp(t - 2.0, 0.0, 1.0) - std::clamp((t - 5.0) / 0.3, 0.0, 1.0));
}

std::vector<double> RampsAndRests() {
  return Sampled(7.3, kRate_hz, [](double t) { return kRadPerDeg * RampsAndRests_deg(t); });
}

int Length(const std::vector<TickRange>& ranges) {
  int sum = 0;
  for (const TickRange& range : ranges) sum += range.end - range.begin;
  return sum;
}

TEST(Wearer, MovementsAreTheRamps) {
  const auto motion = AnalyseWearer(RampsAndRests(), kRate_hz, {});
  ASSERT_EQ(motion.movements.size(), 2u);
  const Movement& out = motion.movements[0];
  EXPECT_NEAR(out.begin, 2000, 6);
  EXPECT_NEAR(out.end, 3000, 6);
  EXPECT_NEAR(out.amplitude_rad(), 30.0 * kRadPerDeg, 1e-2);
  EXPECT_EQ(out.direction(), 1.0);
  EXPECT_TRUE(out.from_rest);
  EXPECT_EQ(motion.movements[1].direction(), -1.0);
  EXPECT_NEAR(motion.movements[1].begin, 5000, 6);
}

TEST(Wearer, RegimesFollowTheSpeed) {
  const auto motion = AnalyseWearer(RampsAndRests(), kRate_hz, {});
  EXPECT_NEAR(Length(motion.Of(Regime::kRest)), 3 * 1500, 20);
  EXPECT_NEAR(Length(motion.Of(Regime::kSlow)), 1000, 20);
  EXPECT_NEAR(Length(motion.Of(Regime::kFast)), 300, 20);
  EXPECT_EQ(Length(motion.Of(Regime::kOnset)), 600);
  EXPECT_TRUE(motion.Of(Regime::kReversal).empty());
  EXPECT_NEAR(motion.Of(Regime::kRest)[1].begin, 3500, 6);
}

TEST(Wearer, LabelsWinOverTheSpeed) {
  const Segment labels[] = {{"slow", 0, 2000}, {"fast", 2000, 3000},   {"rest", 3000, 5000},
                            {"onset", 1, 5},   {"reversal", 90, 9000}, {"of no meaning", 0, 9}};
  const auto motion = AnalyseWearer(RampsAndRests(), kRate_hz, labels);
  EXPECT_NEAR(Length(motion.Of(Regime::kSlow)), 2000, 10);
  EXPECT_NEAR(Length(motion.Of(Regime::kFast)), 1300, 10);
  EXPECT_NEAR(Length(motion.Of(Regime::kRest)), 3000, 10);
  EXPECT_EQ(Length(motion.Of(Regime::kOnset)), 4);
  EXPECT_EQ(Length(motion.Of(Regime::kReversal)), 7300 - 90);
  EXPECT_EQ(motion.movements.size(), 2u);
}

TEST(Wearer, ASineTurnsTwiceAPeriodAndNeverRests) {
  const auto sine = Sampled(10.0, kRate_hz, [](double t) { return 0.5 * std::sin(2 * kPi * t); });
  const auto motion = AnalyseWearer(sine, kRate_hz, {});
  EXPECT_TRUE(motion.Of(Regime::kRest).empty());
  EXPECT_TRUE(motion.Of(Regime::kOnset).empty());
  ASSERT_EQ(motion.Of(Regime::kReversal).size(), 20u);
  EXPECT_NEAR(motion.Of(Regime::kReversal)[3].begin, 1750 - 150, 1);
  EXPECT_EQ(Length(motion.Of(Regime::kReversal)), 20 * 300);
  // |cos| < v/peak over 2/pi asin(v/peak) of the time.
  const double share = 2.0 / kPi * std::asin(60.0 * kRadPerDeg / (0.5 * 2.0 * kPi));
  EXPECT_NEAR(Length(motion.Of(Regime::kSlow)), 10000 * share, 100);
  for (std::size_t i = 1; i + 1 < motion.movements.size(); ++i) {
    EXPECT_NEAR(motion.movements[i].amplitude_rad(), 1.0, 1e-4);
    EXPECT_NEAR(motion.movements[i].end - motion.movements[i].begin, 500, 1);
  }
}

TEST(Wearer, RestsFromThreeTenthsOfASecondOn) {
  for (const double pause_s : {0.28, 0.32}) {
    const auto stairs = Sampled(4.0, kRate_hz, [pause_s](double t) {
      return std::clamp(t - 1.0, 0.0, 0.5) + std::clamp(t - 1.5 - pause_s, 0.0, 0.5);
    });
    const auto motion = AnalyseWearer(stairs, kRate_hz, {});
    const bool rests = pause_s > 0.3;
    EXPECT_EQ(motion.movements.size(), rests ? 2u : 1u);
    EXPECT_EQ(motion.Of(Regime::kOnset).size(), rests ? 2u : 1u);
    EXPECT_EQ(motion.movements.back().from_rest, true);
  }
}

TEST(Wearer, CountsNoTickTwiceWhereReversalsFollowCloseOnEachOther) {
  // Turning points every 0.2 s from 0.1 s on, each with 0.15 s to both sides.
  const auto sine = Sampled(2.0, kRate_hz, [](double t) { return std::sin(5.0 * kPi * t); });
  const auto motion = AnalyseWearer(sine, kRate_hz, {});
  const auto& reversals = motion.Of(Regime::kReversal);
  ASSERT_EQ(reversals.size(), 10u);
  for (std::size_t i = 1; i < reversals.size(); ++i) {
    EXPECT_EQ(reversals[i].begin, reversals[i - 1].end) << i;
  }
  EXPECT_EQ(Length(reversals), 2000);
}

TEST(Wearer, MovesUntilItsFarthestPoint) {
  // Up by 30 deg, back by 20 and, before it rests, forward by 3, which is no movement.
  const auto angle = Sampled(5.0, kRate_hz, [](double t) {
    return kRadPerDeg *
           (30.0 * std::clamp(t - 1.0, 0.0, 1.0) - 40.0 * std::clamp(t - 2.0, 0.0, 0.5) +
            10.0 * std::clamp(t - 2.5, 0.0, 0.3));
  });
  const auto motion = AnalyseWearer(angle, kRate_hz, {});
  ASSERT_EQ(motion.movements.size(), 2u);
  EXPECT_EQ(motion.movements[0].end, 2000);
  EXPECT_EQ(motion.movements[1].begin, 2000);
  EXPECT_EQ(motion.movements[1].end, 2500);
  EXPECT_NEAR(motion.movements[1].to_rad, 10.0 * kRadPerDeg, 1e-9);
}

TEST(Wearer, TremblingBelowTheSmallestMovementMakesNoMovements) {
  const auto tremble = Sampled(5.0, kRate_hz, [](double t) {
    return kRadPerDeg * (10.0 * t + 2.0 * std::sin(2.0 * kPi * 8.0 * t));
  });
  EXPECT_EQ(AnalyseWearer(tremble, kRate_hz, {}).movements.size(), 1u);
}

TEST(Wearer, RegimesOfEverySampleAreAtMostOneOfRestSlowFast) {
  const auto noise = Noise(20000, 4);
  double state = 0.0;
  std::vector<double> angle;
  for (const double value : noise) angle.push_back(state += 0.002 * value);
  const auto motion = AnalyseWearer(angle, kRate_hz, {});
  std::vector<int> seen(angle.size());
  for (const Regime regime : {Regime::kRest, Regime::kSlow, Regime::kFast}) {
    for (const TickRange& range : motion.Of(regime)) {
      for (int n = range.begin; n < range.end; ++n) ++seen.at(n);
    }
  }
  EXPECT_LE(*std::max_element(seen.begin(), seen.end()), 1);
}

TEST(Wearer, OfNothingDoesNothing) {
  const auto motion = AnalyseWearer({}, kRate_hz, {});
  EXPECT_TRUE(motion.movements.empty());
  for (const auto& ranges : motion.regimes) EXPECT_TRUE(ranges.empty());
}

}  // namespace
}  // namespace gauntlet::sim
