#include "sim/show/video/running_scores.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "sim/score/score.h"

namespace gauntlet::sim {
namespace {

constexpr double kRate_hz = 1000.0;
constexpr double kJitterAbove_hz = 15.0;

/// A slow motion; the hand adds an offset and a trembling of 20 Hz, other sizes on each channel.
Signal MovedJoints(int samples, double offset_rad, double trembling_rad) {
  Signal signal(samples, 3);
  for (int channel = 0; channel < 3; ++channel) {
    for (int i = 0; i < samples; ++i) {
      const double turn = 2.0 * std::numbers::pi * i / kRate_hz;
      signal(i, channel) = 0.5 * std::sin(0.4 * turn + channel) + (channel + 1) * offset_rad +
                           (channel + 1) * trembling_rad * std::sin(20.0 * turn);
    }
  }
  return signal;
}

double SummaryOf(const ScoreInput& input, std::string_view key) {
  const std::vector<std::string> joints = {"a", "b", "c"};
  const Scores scores = ComputeScores(input, ScoreRows(joints, {}, {}));
  for (std::size_t i = 0; i < Metrics().size(); ++i) {
    if (Metrics()[i].key == key) return scores.summary[i];
  }
  return NAN;
}

TEST(RunningScores, EndAtTheScoresOfTheTable) {
  const Signal truth = MovedJoints(5017, 0.0, 0.0), hand = MovedJoints(5017, 0.02, 0.005);
  const RunningScores scores = ComputeRunningScores(truth, hand, kRate_hz, kJitterAbove_hz,
                                                    FrameClock(kRate_hz, 30, truth.rows()));
  ScoreInput input;
  input.rate_hz = kRate_hz;
  input.jitter_above_hz = kJitterAbove_hz;
  input.reference_angle_rad = &truth;
  input.hand_angle_rad = &hand;
  EXPECT_NEAR(scores.tracking_rmse_deg.back(), SummaryOf(input, "tracking_rmse_deg"), 1e-9);
  EXPECT_NEAR(scores.jitter_rms_deg.back(), SummaryOf(input, "jitter_rms_deg"), 1e-9);
}

TEST(RunningScores, EndAtTheScoresOfTheTableWhereARecordingHasGaps) {
  const Signal truth = MovedJoints(9017, 0.0, 0.0);
  Signal hand = MovedJoints(9017, 0.02, 0.005);
  hand.col(0).segment(3000, 500).array() += 1.0;  // what nobody knows of, of one channel
  hand.col(2).array() += 1.0;                     // and all of another
  CountedParts counted;
  counted.joints = {{{0, 3000}, {3700, 9017}}, {{0, 9017}}, {}};
  counted.hand = counted.joints[0];
  const RunningScores scores =
      ComputeRunningScores(truth, hand, kRate_hz, kJitterAbove_hz,
                           FrameClock(kRate_hz, 30, truth.rows()), counted.joints);
  ScoreInput input;
  input.rate_hz = kRate_hz;
  input.jitter_above_hz = kJitterAbove_hz;
  input.reference_angle_rad = &truth;
  input.hand_angle_rad = &hand;
  input.counted = &counted;
  EXPECT_NEAR(scores.tracking_rmse_deg.back(), SummaryOf(input, "tracking_rmse_deg"), 1e-9);
  EXPECT_NEAR(scores.jitter_rms_deg.back(), SummaryOf(input, "jitter_rms_deg"), 1e-9);
  EXPECT_NEAR(scores.tracking_rmse_deg.back(), 0.03 * kDegPerRad, 0.05);  // 0.02 and 0.04 rad
  // Within the gap nothing is added but what the other channel says.
  EXPECT_NEAR(scores.tracking_rmse_deg[105], scores.tracking_rmse_deg[89], 0.05);
}

TEST(RunningScores, GrowWhereTheHandGoesAstray) {
  const Signal truth = MovedJoints(4000, 0.0, 0.0);
  Signal hand = truth;
  hand.bottomRows(2000).array() += 0.1;  // from 2 s on
  const FrameClock clock(kRate_hz, 10, truth.rows());
  const RunningScores scores = ComputeRunningScores(truth, hand, kRate_hz, kJitterAbove_hz, clock);
  EXPECT_EQ(scores.tracking_rmse_deg[19], 0.0);
  EXPECT_GT(scores.tracking_rmse_deg[20], 0.0);
  // At the end half of the samples are 0.1 rad off.
  EXPECT_NEAR(scores.tracking_rmse_deg.back(), 0.1 * kDegPerRad * std::sqrt(0.5), 1e-9);
}

TEST(RunningScores, HaveNoJitterBeforeTheFilterHasOne) {
  const Signal truth = MovedJoints(4000, 0.0, 0.0), hand = MovedJoints(4000, 0.0, 0.01);
  const RunningScores scores = ComputeRunningScores(truth, hand, kRate_hz, kJitterAbove_hz,
                                                    FrameClock(kRate_hz, 10, truth.rows()));
  EXPECT_TRUE(std::isnan(scores.jitter_rms_deg[0]));
  // Sines of 0.01, 0.02, 0.03 rad have 1 / sqrt(2) of it as RMS: 0.02 rad on the mean.
  EXPECT_NEAR(scores.jitter_rms_deg.back(), 0.02 * kDegPerRad / std::numbers::sqrt2, 1e-3);
}

TEST(RunningScores, StandStillAfterATrialWasStopped) {
  const Signal truth = MovedJoints(4000, 0.0, 0.0);
  const Signal hand = truth.topRows(1500).array() + 0.1;
  const RunningScores scores = ComputeRunningScores(truth, hand, kRate_hz, kJitterAbove_hz,
                                                    FrameClock(kRate_hz, 30, truth.rows()));
  EXPECT_EQ(scores.tracking_rmse_deg.size(), 120u);
  EXPECT_NEAR(scores.tracking_rmse_deg.back(), 0.1 * kDegPerRad, 1e-9);
}

}  // namespace
}  // namespace gauntlet::sim
