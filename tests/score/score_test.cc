#include "sim/score/score.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <set>
#include <stdexcept>
#include <string>
#include <thread>

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

const std::vector<std::string> kJoints = {"a", "b", "c"};
/// Joints, and motors that are called like them.
const ScoreRows kThreeRows(kJoints, kJoints, {});

/// A wearer of two joints that move and one that does not; a hand that is 37 ms late.
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

TEST(Metrics, AreFoundByTheirKeysAndByNoOther) {
  EXPECT_EQ(Metrics()[MetricIndex("delay_ms")].key, "delay_ms");
  EXPECT_EQ(FindMetric("delay_s"), std::nullopt);
  EXPECT_THROW(MetricIndex("delay_s"), std::invalid_argument);
}

TEST(Metrics, HaveDistinctKeysWithUnitsAndWords) {
  std::set<std::string_view> keys;
  for (const Metric& metric : Metrics()) {
    EXPECT_TRUE(keys.insert(metric.key).second) << metric.key;
    EXPECT_FALSE(metric.help.empty());
    EXPECT_FALSE(metric.definition.empty());
  }
}

TEST(Metrics, SayFromWhereOnADifferenceMatters) {
  for (const Metric& metric : Metrics()) {
    EXPECT_GT(metric.relevant_difference.absolute, 0.0) << metric.key;  // also beside a zero
    EXPECT_GE(metric.relevant_difference.relative, 0.0) << metric.key;
    EXPECT_LT(metric.relevant_difference.relative, 0.5) << metric.key;
    EXPECT_FALSE(metric.relevant_difference.reason.empty()) << metric.key;
  }
  const Metric& jitter = Metrics()[MetricIndex("jitter_rms_deg")];
  EXPECT_EQ(RelevantDifferenceBetween(jitter, 3.0, 90.0), 0.05);
  const Metric& reversals = Metrics()[MetricIndex("command_reversals_per_s")];
  EXPECT_EQ(RelevantDifferenceBetween(reversals, 20.0, 30.0), 2.0);  // of the smaller
  EXPECT_EQ(RelevantDifferenceBetween(reversals, 30.0, 20.0), 2.0);
  EXPECT_EQ(RelevantDifferenceBetween(reversals, 0.0, 30.0), 0.5);
  EXPECT_TRUE(std::isnan(RelevantDifferenceBetween(reversals, std::nan(""), 30.0)));
}

TEST(Scores, OfATrialThatSaysNothingAreNone) {
  const Scores scores = NoScores(kThreeRows);
  EXPECT_EQ(scores.summary.size(), Metrics().size());
  ASSERT_EQ(scores.channels.size(), kThreeRows.names.size());
  for (const double value : scores.channels[1]) EXPECT_TRUE(std::isnan(value));
}

TEST(Scores, OfAKnownHandAreTheKnownValues) {
  const Example example;
  const Scores scores = ComputeScores(example.Input(), kThreeRows);
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
  const Scores scores = ComputeScores(example.Input(), kThreeRows);
  EXPECT_TRUE(std::isnan(scores.channels[2][IndexOf("delay_ms")]));
  EXPECT_EQ(scores.channels[2][IndexOf("aligned_rmse_deg")],
            scores.channels[2][IndexOf("tracking_rmse_deg")]);
}

TEST(Scores, WithoutTheirSignalDoNotExist) {
  const Example example;
  ScoreInput input = example.Input();
  input.command_counts = nullptr;
  EXPECT_TRUE(
      std::isnan(ComputeScores(input, kThreeRows).summary[IndexOf("command_reversals_per_s")]));
}

TEST(Scores, OfAHandStoppedEarlyAreThoseOfItsRows) {
  const Example example;
  ScoreInput input = example.Input();
  const Signal hand = example.hand.topRows(7000);
  const Signal reference = example.reference.topRows(7000);
  input.hand_angle_rad = &hand;
  const Scores longer = ComputeScores(input, kThreeRows);
  input.reference_angle_rad = &reference;
  const Scores exact = ComputeScores(input, kThreeRows);
  EXPECT_EQ(std::memcmp(longer.summary.data(), exact.summary.data(),
                        exact.summary.size() * sizeof(double)),
            0);
  const Signal nothing(0, 3);
  input.hand_angle_rad = &nothing;
  for (const double value : ComputeScores(input, kThreeRows).summary)
    EXPECT_TRUE(std::isnan(value));
}

const std::vector<std::string> kTwoJoints = {"a", "b"};
const std::vector<std::string> kTwoMotors = {"a", "pull"};
const std::vector<std::string> kThreeCables = {"a_flexor", "a_extensor", "pull_flexor"};
const ScoreRows kFullRows = [] {
  ScoreRows rows(kTwoJoints, kTwoMotors, kThreeCables);
  rows.joint_groups = {ScoredGroup::kFinger, ScoredGroup::kArm};
  return rows;
}();

/// All that a metric may need: a wearer who rests, moves and turns, with motors and cables.
struct FullExample {
  static constexpr int kSamples = 30000;
  Signal reference = Signal::Zero(kSamples, 2);
  Signal hand = Signal::Zero(kSamples, 2);
  IntegerSignal command = IntegerSignal::Zero(kSamples, 2);
  Signal speed = Signal::Zero(kSamples, 2);
  Signal tension = Signal::Zero(kSamples, 3);
  Signal grip = Signal::Zero(kSamples, 1);
  Signal object_force = Signal::Zero(kSamples, 2);
  Signal object_pose = Signal::Zero(kSamples, 7);
  Signal object_in_palm = Signal::Zero(kSamples, 7);
  Signal hand_tips = Signal::Zero(kSamples / 10, 9);
  Signal reference_tips = Signal::Zero(kSamples / 10, 9);
  Signal overlap = Signal::Zero(kSamples, 1);
  Signal sample_age = Signal::Zero(kSamples, 1);
  SignalOf<std::uint8_t> tier = SignalOf<std::uint8_t>::Zero(kSamples, 1);
  std::vector<double> deg_per_count{0.1, 0.2};
  std::vector<double> saturation{0.25, 0.75};
  std::vector<double> stall_tension_n{12.0, 4.0, 10.0};
  Signal noise_free_hand = Signal::Zero(kSamples, 2);
  Signal noise_free_speed = Signal::Zero(kSamples, 2);
  Signal exact_hand = Signal::Zero(kSamples, 2);
  Signal arm_at_rest = Signal::Zero(kSamples, 2);
  Signal palm_velocity = Signal::Zero(kSamples, 3);

  FullExample() {
    const auto noise = Noise(2 * kSamples, 12);
    for (int n = 0; n < kSamples; ++n) {
      for (int c = 0; c < 2; ++c) {
        const double white = 0.3 * kRadPerDeg * noise[2 * n + c];
        reference(n, c) = At(n, c);
        noise_free_hand(n, c) = At(n - 60, c);
        hand(n, c) = noise_free_hand(n, c) + white;
        arm_at_rest(n, c) = noise_free_hand(n, c) + 0.6 * white;
        exact_hand(n, c) = At(n, c) + 0.01;
        noise_free_speed(n, c) = 0.7 * std::sin(2.0 * kPi * 1.0 * n / 1000.0);
        command(n, c) = static_cast<int>(100.0 * At(n / 20 * 20, c));
        speed(n, c) =
            noise_free_speed(n, c) + 0.5 * std::sqrt(2.0) * std::sin(2.0 * kPi * 40.0 * n / 1000.0);
      }
      palm_velocity(n, 1) = 0.01 * std::sqrt(2.0) * std::sin(2.0 * kPi * 40.0 * n / 1000.0);
      grip(n, 0) = 9.0 + std::sqrt(2.0) * std::sin(2.0 * kPi * 25.0 * n / 1000.0);
      object_force(n, 0) = n < kSamples / 2 ? 0.0 : 3.0;
      object_force(n, 1) = n < kSamples / 2 ? 3.0 : 0.0;
      object_pose(n, 3) = object_in_palm(n, 3) = 1.0;
      object_in_palm(n, 0) = n < kSamples - 100 ? 0.0 : 0.004;
      overlap(n, 0) = n < kSamples / 10 ? 2.1e-3 : n < kSamples / 2 ? 1.9e-3 : 0.0;
      tension(n, 0) = n < kSamples / 10 ? 0.0 : 3.0;
      tension(n, 1) = 1.0;
      sample_age(n, 0) = 1e-3 * (25 + n % 20);
      if (n >= 1000 && n < 1100) sample_age(n, 0) = 1e-3 * (25 + n - 1000);  // frames are lost
      tier(n, 0) = n < 300 ? 1 : n < 500 ? 2 : n < 600 ? 3 : 0;
      tension(n, 2) = n == 77 ? 8.0 : 2.0;
    }
    hand_tips.col(3).setConstant(0.022);  // the second 22 mm from the first in place of 20
    reference_tips.col(3).setConstant(0.02);
  }
  /// Ten seconds of rest, then slow, then fast turns.
  static double At(int n, int channel) {
    const double t = n / 1000.0 - 10.0;
    if (t < 0.0) return 0.0;
    return 0.4 * (1.0 - std::cos(2.0 * kPi * (t < 10.0 ? 0.2 : 1.2 + 0.1 * channel) * t));
  }
  ScoreInput Input() const {
    return {.reference_angle_rad = &reference,
            .hand_angle_rad = &hand,
            .command_counts = &command,
            .motor_speed_rad_s = &speed,
            .tension_n = &tension,
            .grip_force_n = &grip,
            .object_force_n = &object_force,
            .object_pose = &object_pose,
            .object_in_palm = &object_in_palm,
            .object_friction = 0.5,
            .palm_velocity_m_s = &palm_velocity,
            .arm_at_rest_angle_rad = &arm_at_rest,
            .digit_overlap_m = &overlap,
            .sample_age_s = &sample_age,
            .watchdog_tier = &tier,
            .ticks_per_command = 20.0,
            .deg_per_count = deg_per_count,
            .fingertips = {.hand_m = &hand_tips,
                           .reference_m = &reference_tips,
                           .ticks_per_row = 10,
                           .measured = {1},
                           .pinches = {{0, 1}}},
            .saturation_share = saturation,
            .noise_free_hand_angle_rad = &noise_free_hand,
            .noise_free_motor_speed_rad_s = &noise_free_speed,
            .without = {&noise_free_hand, &noise_free_hand, &exact_hand, &exact_hand, &exact_hand,
                        &exact_hand, &exact_hand, &exact_hand, &exact_hand},
            .switched_off = {&noise_free_hand, &exact_hand, &exact_hand, &exact_hand, &exact_hand,
                             &exact_hand},
            .switched_off_ticks = kSamples,
            .stall_tension_n = stall_tension_n};
  }
};

TEST(Scores, OfALinkAreThoseOfItsSignals) {
  FullExample example;
  example.command.setZero();
  example.command(500, 1) = 40;
  const Scores scores = ComputeScores(example.Input(), kFullRows);
  const auto value = [&](const char* key) { return scores.summary[MetricIndex(key)]; };
  EXPECT_NEAR(value("sample_age_p50_ms"), 34.0, 1.0);
  EXPECT_NEAR(value("sample_age_p99_ms"), 44.0, 1.0);
  EXPECT_DOUBLE_EQ(value("sample_age_max_ms"), 124.0);
  constexpr double kSampleCount = FullExample::kSamples;
  // Four of the five frames of the gap.
  EXPECT_NEAR(value("frozen_share"), 80.0 / (kSampleCount - 20.0), 1e-12);
  EXPECT_NEAR(value("watchdog_hold_share"), 300.0 / kSampleCount, 1e-12);
  EXPECT_NEAR(value("watchdog_relax_share"), 200.0 / kSampleCount, 1e-12);
  EXPECT_NEAR(value("watchdog_off_share"), 100.0 / kSampleCount, 1e-12);
  EXPECT_DOUBLE_EQ(scores.channels[2][MetricIndex("command_jump_deg")], 40.0 * 0.2);
}

TEST(Scores, AllExistWhereAllSignalsDo) {
  const FullExample example;
  const Scores scores = ComputeScores(example.Input(), kFullRows);
  for (std::size_t i = 0; i < Metrics().size(); ++i) {
    const bool has_joints = Metrics()[i].key != "wrist_jitter_rms_deg";  // none is of the wrist
    EXPECT_EQ(std::isfinite(scores.summary[i]), Metrics()[i].alike && has_joints)
        << Metrics()[i].key;
    const ScoredPart part = Metrics()[i].part;
    // Rows: the joint and motor a, the joint b, the motor pull, three cables.
    ASSERT_EQ(scores.channels.size(), 6u);
    for (std::size_t row = 0; row < 6; ++row) {
      const bool has = (part == ScoredPart::kJoint && row < 2) ||
                       (part == ScoredPart::kMotor && (row == 0 || row == 2)) ||
                       (part == ScoredPart::kCable && row > 2);
      EXPECT_EQ(std::isfinite(scores.channels[row][i]), has) << Metrics()[i].key << " " << row;
    }
  }
}

TEST(Scores, OfFingersAndArmAreToldApart) {
  FullExample example;
  example.hand.col(1) += 0.5 * (example.hand.col(1) - example.noise_free_hand.col(1));
  const Scores scores = ComputeScores(example.Input(), kFullRows);
  const auto value = [&](std::string_view key) { return scores.summary[IndexOf(key)]; };
  EXPECT_NEAR(value("finger_jitter_rms_deg"), 0.3 * std::sqrt(0.98), 0.01);
  EXPECT_NEAR(value("arm_jitter_rms_deg"), 0.45 * std::sqrt(0.98), 0.015);
  EXPECT_NEAR(value("arm_share_of_finger_jitter"), 0.4, 1e-3);
  // 40 Hz: 2 sin(pi 40 / 1000) of the speed's RMS from tick to tick.
  EXPECT_NEAR(value("palm_acceleration_m_s2"), 0.01 * 2.0 * 1000.0 * std::sin(kPi * 0.04), 1e-3);
}

TEST(Scores, OfRegimesMotorsAndCablesAreTheKnownValues) {
  const FullExample example;
  const Scores scores = ComputeScores(example.Input(), kFullRows);
  const auto value = [&](std::string_view key) { return scores.channels[0][IndexOf(key)]; };
  EXPECT_NEAR(value("rest_jitter_deg"), 0.3, 0.01);
  EXPECT_NEAR(value("rest_tracking_rmse_deg"), 0.3, 0.01);
  EXPECT_NEAR(value("slow_jitter_rms_deg"), 0.3 * std::sqrt(0.98), 0.01);
  EXPECT_NEAR(value("fast_jitter_rms_deg"), 0.3 * std::sqrt(0.98), 0.01);
  EXPECT_GT(value("fast_tracking_rmse_deg"), 3.0 * value("slow_tracking_rmse_deg"));
  EXPECT_LT(value("reversal_tracking_rmse_deg"), value("fast_tracking_rmse_deg"));
  EXPECT_NEAR(value("delay_ms"), 60.0, 0.5);
  EXPECT_NEAR(value("onset_delay_ms"), 60.0, 10.0);
  EXPECT_NEAR(value("noise_jitter_rms_deg"), 0.3 * std::sqrt(0.98), 0.01);
  EXPECT_NEAR(value("motor_speed_rms_deg_s"), std::hypot(0.5, std::sqrt(0.5) * 0.7) * kDegPerRad,
              1e-6);
  EXPECT_LT(value("motor_speed_centroid_hz"), 30.0);  // the motion draws it down
  EXPECT_NEAR(value("motor_noise_rms_deg_s"), 0.5 * kDegPerRad, 1e-6);
  EXPECT_NEAR(value("motor_noise_centroid_hz"), 40.0, 0.02);
  EXPECT_DOUBLE_EQ(value("saturation_share"), 0.25);
  const auto of_cable = [&](std::size_t cable, std::string_view key) {
    return scores.channels[kFullRows.cables[cable]][IndexOf(key)];
  };
  EXPECT_DOUBLE_EQ(of_cable(0, "slack_share"), 0.1);
  EXPECT_DOUBLE_EQ(of_cable(1, "slack_share"), 0.0);
  EXPECT_DOUBLE_EQ(of_cable(2, "tension_peak_n"), 8.0);
  EXPECT_TRUE(std::isnan(scores.summary[IndexOf("tension_peak_n")]));
  EXPECT_DOUBLE_EQ(of_cable(2, "tension_peak_share"), 0.8);
  EXPECT_DOUBLE_EQ(scores.summary[IndexOf("tension_peak_share")], (0.25 + 0.25 + 0.8) / 3.0);
  EXPECT_DOUBLE_EQ(scores.channels[kFullRows.motors[1]][IndexOf("saturation_share")], 0.75);
  EXPECT_DOUBLE_EQ(scores.summary[IndexOf("saturation_share")], 0.5);
  EXPECT_NEAR(scores.summary[IndexOf("grip_force_ripple_n")], 1.0, 1e-3);
  EXPECT_NEAR(scores.summary[IndexOf("object_slip_mm")], 4.0, 1e-9);
  EXPECT_NEAR(scores.summary[IndexOf("object_tilt_deg")], 0.0, 1e-9);
  EXPECT_NEAR(scores.summary[IndexOf("grip_force_ratio")],
              0.5 * (9.0 - std::sqrt(2.0) * 2.0 / kPi) / 3.0, 0.01);
  EXPECT_EQ(scores.summary[IndexOf("lost_contact_share")], 0.0);
  EXPECT_NEAR(scores.summary[IndexOf("fingertip_error_mm")], 2.0, 1e-9);
  EXPECT_NEAR(scores.summary[IndexOf("pinch_distance_error_mm")], 2.0, 1e-9);
  EXPECT_DOUBLE_EQ(scores.summary[IndexOf("digit_overlap_share")], 0.1);
}

TEST(Scores, PartsOfTheErrorSumToTheSquareOfTheTrackingError) {
  const FullExample example;
  const Scores scores = ComputeScores(example.Input(), kFullRows);
  ASSERT_EQ(TrackingErrorParts().size(), kErrorCauseCount);
  double summaries = 0.0;
  double squares = 0.0;
  for (const std::size_t row : kFullRows.joints) {
    double sum = 0.0;
    for (const CauseMetric& part : TrackingErrorParts()) {
      EXPECT_EQ(Metrics()[part.metric].key, part.key);
      sum += scores.channels[row][part.metric];
    }
    const double tracking = scores.channels[row][IndexOf("tracking_rmse_deg")];
    EXPECT_NEAR(sum / (tracking * tracking), 1.0, 1e-9);
    squares += tracking * tracking;
  }
  for (const CauseMetric& part : TrackingErrorParts()) summaries += scores.summary[part.metric];
  EXPECT_NEAR(summaries / (squares / 2.0), 1.0, 1e-9);
}

/// Offsets of the hand by steps in time, so that the RMS of each stretch is known.
TEST(Scores, OfSwitchedCausesAreOfTheirTicks) {
  const FullExample example;
  Signal hand = example.reference;
  hand.array() += 4.0 / kDegPerRad;
  hand.bottomRows(hand.rows() / 2).array() += 3.0 / kDegPerRad;
  Signal without_link = example.reference.topRows(hand.rows() / 2);
  without_link.array() -= 1.0 / kDegPerRad;
  ScoreInput input = example.Input();
  input.hand_angle_rad = &hand;
  input.switched_off = {};
  input.switched_off[2] = &without_link;
  input.switched_off_ticks = static_cast<int>(without_link.rows());
  const Scores scores = ComputeScores(input, kFullRows);
  const auto value = [&](const char* key) { return scores.summary[IndexOf(key)]; };
  EXPECT_NEAR(value("error_with_all_deg"), 4.0, 1e-9);
  EXPECT_NEAR(value("error_without_link_deg"), 1.0, 1e-9);
  EXPECT_TRUE(std::isnan(value("error_without_servo_deg")));
  EXPECT_NEAR(value("tracking_rmse_deg"), std::sqrt((16.0 + 49.0) / 2.0), 1e-9);
}

/// The share is of the fingers' jitter in the time of the trial with the arm at rest, not of all.
TEST(Scores, ShareOfTheArmIsOfTheTimeOfItsTrial) {
  FullExample example;
  const Eigen::Index half = FullExample::kSamples / 2;
  example.hand.bottomRows(half) +=
      2.0 * (example.hand - example.noise_free_hand).bottomRows(half).eval();
  const Signal at_rest = example.arm_at_rest.topRows(half);
  ScoreInput input = example.Input();
  input.arm_at_rest_angle_rad = &at_rest;
  const Scores scores = ComputeScores(input, kFullRows);
  EXPECT_NEAR(scores.summary[IndexOf("arm_share_of_finger_jitter")], 0.4, 1e-3);
}

TEST(Scores, OfNoiseNeedTheNoiseFreeTrial) {
  const FullExample example;
  ScoreInput input = example.Input();
  input.noise_free_hand_angle_rad = nullptr;
  input.noise_free_motor_speed_rad_s = nullptr;
  const Scores scores = ComputeScores(input, kFullRows);
  for (const char* key :
       {"noise_jitter_rms_deg", "motor_noise_rms_deg_s", "motor_noise_centroid_hz"}) {
    EXPECT_TRUE(std::isnan(scores.summary[IndexOf(key)])) << key;
  }
}

TEST(Scores, OfNoiseThatIsNoneAreZero) {
  FullExample example;
  example.noise_free_hand = example.hand;
  example.noise_free_speed = example.speed;
  const Scores scores = ComputeScores(example.Input(), kFullRows);
  EXPECT_EQ(scores.summary[IndexOf("noise_jitter_rms_deg")], 0.0);
  EXPECT_EQ(scores.summary[IndexOf("error_noise_deg2")], 0.0);
  EXPECT_EQ(scores.summary[IndexOf("motor_noise_rms_deg_s")], 0.0);
  EXPECT_TRUE(std::isnan(scores.summary[IndexOf("motor_noise_centroid_hz")]));
}

TEST(Scores, OfTremblingBeginWhereTheInputSays) {
  FullExample example;
  for (int n = 0; n < FullExample::kSamples; ++n) {
    example.grip(n, 0) += 0.7 * std::sqrt(2.0) * std::sin(2.0 * kPi * 9.0 * n / 1000.0);
    example.hand(n, 0) = 0.5 * kRadPerDeg * std::sqrt(2.0) * std::sin(2.0 * kPi * 9.0 * n / 1000.0);
    example.noise_free_hand(n, 0) = 0.4 * example.hand(n, 0);
  }
  ScoreInput input = example.Input();
  input.jitter_above_hz = 7.5;
  const Scores scores = ComputeScores(input, kFullRows);
  EXPECT_NEAR(scores.channels[0][IndexOf("jitter_rms_deg")], 0.5, 1e-3);
  EXPECT_NEAR(scores.channels[0][IndexOf("noise_jitter_rms_deg")], 0.3, 1e-3);
  EXPECT_NEAR(scores.summary[IndexOf("grip_force_ripple_n")], std::hypot(1.0, 0.7), 1e-3);
}

TEST(Scores, OfTheOffsetAtRestIsTheSizeOfTheMeanError) {
  FullExample example;
  example.hand.col(0).array() -= 3.0 * kRadPerDeg;  // below the wearer, all the time
  const Scores scores = ComputeScores(example.Input(), kFullRows);
  EXPECT_NEAR(scores.channels[0][IndexOf("rest_offset_deg")], 3.0, 0.01);
  EXPECT_NEAR(scores.channels[1][IndexOf("rest_offset_deg")], 0.0, 0.01);
}

TEST(Scores, FollowLabelsInPlaceOfTheSpeed) {
  const FullExample example;
  ScoreInput input = example.Input();
  const Segment all_rest[] = {{"rest", 0, FullExample::kSamples}};
  input.segments = all_rest;
  const Scores scores = ComputeScores(input, kFullRows);
  EXPECT_TRUE(std::isnan(scores.summary[IndexOf("fast_tracking_rmse_deg")]));
  EXPECT_GT(scores.summary[IndexOf("rest_jitter_deg")], 5.0);
}

bool SameBytes(const std::vector<double>& first, const std::vector<double>& second) {
  return first.size() == second.size() &&
         std::memcmp(first.data(), second.data(), first.size() * sizeof(double)) == 0;
}

TEST(Scores, AreTheSameOnSeveralThreads) {
  const FullExample example;
  const Scores alone = ComputeScores(example.Input(), kFullRows);
  std::vector<Scores> together(4);
  std::vector<std::thread> threads;
  for (Scores& scores : together) {
    threads.emplace_back([&] { scores = ComputeScores(example.Input(), kFullRows); });
  }
  for (std::thread& thread : threads) thread.join();
  for (const Scores& scores : together) {
    EXPECT_TRUE(SameBytes(scores.summary, alone.summary));
    EXPECT_TRUE(SameBytes(scores.channels[1], alone.channels[1]));
  }
}

TEST(Scores, RefuseSignalsThatDoNotFit) {
  const Example example;
  ScoreInput input = example.Input();
  const Signal narrow = example.hand.leftCols(2);
  input.hand_angle_rad = &narrow;
  EXPECT_THROW(ComputeScores(input, kThreeRows), std::invalid_argument);
  input = example.Input();
  input.motor_speed_rad_s = &narrow;
  EXPECT_THROW(ComputeScores(input, kThreeRows), std::invalid_argument);
  input = example.Input();
  input.tension_n = &example.hand;  // of cables that are not in the table
  EXPECT_THROW(ComputeScores(input, kThreeRows), std::invalid_argument);
  input = example.Input();
  input.grip_force_n = &narrow;
  EXPECT_THROW(ComputeScores(input, kThreeRows), std::invalid_argument);
  input = example.Input();
  input.object_in_palm = &narrow;
  EXPECT_THROW(ComputeScores(input, kThreeRows), std::invalid_argument);
  input = example.Input();
  input.fingertips = {.hand_m = &example.hand, .reference_m = &narrow};
  EXPECT_THROW(ComputeScores(input, kThreeRows), std::invalid_argument);
  input = example.Input();
  input.digit_overlap_m = &narrow;
  EXPECT_THROW(ComputeScores(input, kThreeRows), std::invalid_argument);
  input = example.Input();
  const double one_share[] = {0.5};
  input.saturation_share = one_share;
  EXPECT_THROW(ComputeScores(input, kThreeRows), std::invalid_argument);
  input = example.Input();
  input.noise_free_hand_angle_rad = &narrow;
  EXPECT_THROW(ComputeScores(input, kThreeRows), std::invalid_argument);
  input = example.Input();
  input.without[3] = &narrow;
  EXPECT_THROW(ComputeScores(input, kThreeRows), std::invalid_argument);
  input = example.Input();
  input.switched_off[3] = &narrow;
  input.switched_off_ticks = 1;
  EXPECT_THROW(ComputeScores(input, kThreeRows), std::invalid_argument);
  input = example.Input();
  input.switched_off_ticks = 0;  // with trials of which nothing is scored
  EXPECT_THROW(ComputeScores(input, kFullRows), std::invalid_argument);
  input = example.Input();
  input.jitter_above_hz = 0.0;
  EXPECT_THROW(ComputeScores(input, kThreeRows), std::invalid_argument);
  input.hand_angle_rad = nullptr;
  EXPECT_THROW(ComputeScores(input, kThreeRows), std::invalid_argument);
}

TEST(Scores, AskedForOneByOneAreThoseOfAllTogether) {
  const FullExample example;
  const Scores all = ComputeScores(example.Input(), kFullRows);
  const auto same = [](double a, double b) { return a == b || (std::isnan(a) && std::isnan(b)); };
  for (std::size_t metric = 0; metric < Metrics().size(); ++metric) {
    const Scores one = ComputeScores(example.Input(), kFullRows, {&metric, 1});
    for (std::size_t m = 0; m < Metrics().size(); ++m) {
      if (m == metric) {
        EXPECT_TRUE(same(one.summary[m], all.summary[m])) << Metrics()[m].key;
      } else {
        EXPECT_TRUE(std::isnan(one.summary[m])) << Metrics()[m].key;
      }
      for (std::size_t row = 0; m == metric && row < all.channels.size(); ++row) {
        EXPECT_TRUE(same(one.channels[row][m], all.channels[row][m])) << Metrics()[m].key;
      }
    }
  }
}

}  // namespace
}  // namespace gauntlet::sim
