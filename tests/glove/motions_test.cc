#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <unsupported/Eigen/FFT>
#include <vector>

#include "sim/base/channels.h"
#include "sim/base/error.h"
#include "sim/glove/glove.h"
#include "sim/glove/motions/minimum_jerk.h"
#include "sim/glove/motions/postures.h"
#include "sim/glove/motions/sequence.h"
#include "sim/glove/motions/tremor.h"
#include "tests/support/source_dir.h"

namespace gauntlet::sim {
namespace {

constexpr double kPi = 3.14159265358979323846;

MotionContext At1kHz(std::uint64_t seed = 1) {
  MotionContext context;
  context.seed = seed;
  return context;
}

MotionConfig SequenceOf(const std::vector<MotionSettings>& parts) {
  SequenceConfig sequence;
  for (const MotionSettings& part : parts) sequence.parts.push_back({.settings = part});
  return {.settings = std::move(sequence)};
}

/// The kind with its defaults; a recording has a file, a sequence has parts.
MotionConfig ExampleOf(const MotionKind& kind) {
  if (kind.name == SequenceConfig::kKind) {
    return SequenceOf({HoldConfig{}, GraspConfig{}, RandomMotionConfig{.duration_s = 2.0}});
  }
  if (kind.name == RecordedMotionConfig::kKind) {
    return {.settings = RecordedMotionConfig{
                .file = SourceDir() + "/scenarios/recordings/door_opening/angles.csv"}};
  }
  return kind.defaults;
}

/// One-sided power spectrum; element k is at k rate / samples. Sums to the variance.
std::vector<double> PowerSpectrum(const Eigen::VectorXd& signal) {
  const double mean = signal.mean();
  std::vector<double> centered(signal.begin(), signal.end());
  for (double& value : centered) value -= mean;
  std::vector<std::complex<double>> spectrum;
  Eigen::FFT<double>().fwd(spectrum, centered);
  std::vector<double> power(centered.size() / 2 + 1);
  const auto size = static_cast<double>(centered.size());
  for (std::size_t k = 0; k < power.size(); ++k)
    power[k] = 2 * std::norm(spectrum[k]) / size / size;
  return power;
}

double PowerBetween(const std::vector<double>& power, double from_hz, double to_hz,
                    double duration_s) {
  double sum = 0.0;
  for (std::size_t k = 0; k < power.size(); ++k) {
    const double frequency = static_cast<double>(k) / duration_s;
    if (frequency >= from_hz && frequency < to_hz) sum += power[k];
  }
  return sum;
}

class EveryMotion : public ::testing::TestWithParam<std::size_t> {
 protected:
  const MotionConfig config_ = ExampleOf(MotionKinds()[GetParam()]);
};

TEST_P(EveryMotion, StaysInsideTheJointRanges) {
  const Motion motion = SynthesiseMotion(config_, At1kHz());
  for (Eigen::Index c = 0; c < 18; ++c) {
    const Channel& joint = GloveChannels()[static_cast<std::size_t>(c)];
    EXPECT_GE(motion.angle_rad.col(c).minCoeff(), joint.min_deg * kRadPerDeg - 1e-9) << joint.name;
    EXPECT_LE(motion.angle_rad.col(c).maxCoeff(), joint.max_deg * kRadPerDeg + 1e-9) << joint.name;
  }
}

TEST_P(EveryMotion, MovesWithoutJumps) {
  if (config_.kind() == "steps") return;
  const Motion motion = SynthesiseMotion(config_, At1kHz());
  const Eigen::Index samples = motion.angle_rad.rows();
  const Eigen::MatrixXd change_rad =
      motion.angle_rad.bottomRows(samples - 1) - motion.angle_rad.topRows(samples - 1);
  const double fastest_rad_s = 1e3 * change_rad.cwiseAbs().maxCoeff();
  EXPECT_LT(fastest_rad_s, 30.0);
  if (config_.kind() != "hold") {
    EXPECT_GT(fastest_rad_s, 0.5);
  }
}

TEST_P(EveryMotion, IsTheSameForTheSameSeed) {
  EXPECT_EQ(SynthesiseMotion(config_, At1kHz(3)).angle_rad,
            SynthesiseMotion(config_, At1kHz(3)).angle_rad);
}

TEST_P(EveryMotion, HasASegmentOnlyIfAPersonNamesIt) {
  MotionConfig config = config_;
  EXPECT_TRUE(SynthesiseMotion(config, At1kHz()).segments.empty());
  config.label = "a word of one's own";
  const Motion motion = SynthesiseMotion(config, At1kHz());
  ASSERT_EQ(motion.segments.size(), 1u);
  EXPECT_EQ(motion.segments[0].label, config.label);
  EXPECT_EQ(motion.segments[0].begin, 0);
  EXPECT_EQ(motion.segments[0].end, motion.angle_rad.rows());
}

INSTANTIATE_TEST_SUITE_P(Kinds, EveryMotion, ::testing::Range<std::size_t>(0, MotionKinds().size()),
                         [](const auto& kind) {
                           return std::string(MotionKinds()[kind.param].name);
                         });

TEST(MinimumJerk, HasTheKnownPeakAndStandsStillAtBothEnds) {
  // Flash and Hogan: the peak speed is 15/8 of the mean speed, in the middle.
  constexpr double kStep = 1e-4;
  const auto slope_at = [](double u) {
    return (MinimumJerkAt(u + kStep) - MinimumJerkAt(u - kStep)) / (2.0 * kStep);
  };
  EXPECT_NEAR(slope_at(0.5), 1.875, 1e-6);
  EXPECT_DOUBLE_EQ(MinimumJerkAt(0.5), 0.5);
  for (const double end : {0.0, 1.0}) {
    EXPECT_DOUBLE_EQ(MinimumJerkAt(end), end);
    EXPECT_NEAR(slope_at(end), 0.0, 1e-6);
  }
}

TEST(Moves, ReachEachPostureAndHoldIt) {
  MovesConfig config;
  config.postures = {"open", "power", "point"};
  config.move_s = 0.5;
  config.hold_s = 0.5;
  const Motion motion = MakeMotion(config, At1kHz());
  ASSERT_EQ(motion.angle_rad.rows(), 3500);
  for (int k = 0; k < 3; ++k) {
    const auto angles = PostureAngles(PostureIndex(config.postures[static_cast<std::size_t>(k)]));
    for (const int i : {1000 * k + 1000, 1000 * k + 1400}) {
      for (int c = 0; c < 18; ++c) EXPECT_NEAR(motion.angle_rad(i, c), angles[c], 1e-12);
    }
  }
  config.postures = {"pwer"};
  EXPECT_THROW(MakeMotion(config, At1kHz()), controller::SettingError);
}

TEST(Grasp, ClosesEveryKindAndComesBackToRest) {
  for (std::size_t kind = 0; kind < Postures().size(); ++kind) {
    GraspConfig config;
    config.grasp = kind;
    config.repeats = 2;
    config.variation_percent = 0.0;
    const Motion motion = MakeMotion(config, At1kHz());
    // Late in the first hold: rest 1 s, reach 0.9 s, hold 1.2 s.
    const auto angles = PostureAngles(kind);
    const auto rest = PostureAngles(0);
    for (int c = 0; c < 18; ++c) {
      EXPECT_NEAR(motion.angle_rad(3050, c), angles[c], 1e-9) << Postures()[kind].name;
      EXPECT_NEAR(motion.angle_rad(motion.angle_rad.rows() - 1, c), rest[c], 1e-9);
    }
  }
}

TEST(Grasp, FingersCloseTogetherFromGraspToGrasp) {
  GraspConfig config;
  config.repeats = 200;
  const Motion motion = MakeMotion(config, At1kHz());
  const double period_s = config.reach_s + config.hold_s + config.release_s + config.rest_s;
  Eigen::VectorXd index(200), ring(200);
  for (int k = 0; k < 200; ++k) {
    const int i = static_cast<int>(1000 * (k * period_s + 3.0));
    index[k] = motion.angle_rad(i, ChannelIndex("index_pip"));
    ring[k] = motion.angle_rad(i, ChannelIndex("ring_pip"));
  }
  index.array() -= index.mean();
  ring.array() -= ring.mean();
  const double correlation = index.dot(ring) / index.norm() / ring.norm();
  // Stated: 80 % of the variance in common; the standard error over 200 grasps is 0.026.
  EXPECT_NEAR(correlation, 0.8, 0.1);
}

TEST(Sine, HasTheGivenFrequencyAmplitudeAndPhase) {
  SineConfig config;
  config.duration_s = 10.0;
  config.frequency_hz = {0.5};
  config.range_percent = 40.0;
  config.phase_step_deg = 90.0;
  config.channels = {"index_pip", "elbow_flexion"};
  const Motion motion = MakeMotion(config, At1kHz());
  const int index = ChannelIndex("index_pip"), elbow = ChannelIndex("elbow_flexion");
  EXPECT_NEAR(motion.angle_rad(500, index) * kDegPerRad, 50.0 + 20.0, 1e-9);
  EXPECT_NEAR(motion.angle_rad(1500, index) * kDegPerRad, 50.0 - 20.0, 1e-9);
  EXPECT_NEAR(motion.angle_rad(0, elbow) * kDegPerRad, 72.5 + 29.0, 1e-9);
  EXPECT_EQ(motion.angle_rad(0, 0), motion.angle_rad(777, 0));
}

TEST(Chirp, GoesThroughTheNumberOfPeriodsOfItsIntegral) {
  ChirpConfig config;
  config.duration_s = 20.0;
  config.from_hz = {0.2};
  config.to_hz = std::vector<double>(18, 3.2);
  config.to_hz[6] = 0.2;
  const Motion motion = MakeMotion(config, At1kHz());
  const auto periods = [&](int channel) {
    const double middle = ChannelExcursion(static_cast<std::size_t>(channel), 0).middle_rad;
    const auto above = (motion.angle_rad.col(channel).array() > middle).eval();
    return (above.head(above.size() - 1) != above.tail(above.size() - 1)).count() / 2.0;
  };
  // Integral of from (to/from)^(t/T): T (to - from) / ln(to / from) = 21.64 periods.
  EXPECT_NEAR(periods(5), 20.0 * 3.0 / std::log(16.0), 0.6);
  EXPECT_NEAR(periods(6), 20.0 * 0.2, 0.6);
  config.from_hz = {1.0, 2.0};
  EXPECT_THROW(MakeMotion(config, At1kHz()), controller::SettingError);
}

TEST(RandomMotion, IsBandLimitedAsStated) {
  RandomMotionConfig config;
  config.duration_s = 2000.0;
  config.bandwidth_hz = 2.0;
  MotionContext context;
  context.rate_hz = 100.0;
  const Signal angle_rad = MakeMotion(config, context).angle_rad;
  double total = 0.0, beyond = 0.0, low = 0.0, at_bandwidth = 0.0;
  for (Eigen::Index c = 0; c < 18; ++c) {
    const auto power = PowerSpectrum(angle_rad.col(c) / ChannelExcursion(c, 80.0).half_rad);
    total += PowerBetween(power, 0.0, 50.0, 2000.0);
    beyond += PowerBetween(power, 6.0, 50.0, 2000.0);
    low += PowerBetween(power, 0.0, 0.2, 2000.0);
    at_bandwidth += PowerBetween(power, 1.9, 2.1, 2000.0);
  }
  EXPECT_LT(beyond / total, 1e-3);
  // -3 dB is half the power; 7,200 bins each give a standard error of 1.2 %.
  EXPECT_NEAR(at_bandwidth / low, 0.5, 0.04);
}

TEST(Sequence, JoinsPartsWithContinuousAngleAndVelocity) {
  const MotionConfig config = SequenceOf({RandomMotionConfig{.bandwidth_hz = 0.3}, SineConfig{},
                                          RandomMotionConfig{.duration_s = 2.0}});
  const Motion motion = SynthesiseMotion(config, At1kHz());
  for (Eigen::Index c = 0; c < 18; ++c) {
    for (Eigen::Index i = 2; i < motion.angle_rad.rows(); ++i) {
      const double bend =
          motion.angle_rad(i, c) - 2 * motion.angle_rad(i - 1, c) + motion.angle_rad(i - 2, c);
      // A jump of the angle or the velocity would show as 1 mrad and more per sample.
      ASSERT_LT(std::abs(bend), 3e-4) << c << " " << i;
    }
  }
}

TEST(Sequence, HoldsWhereThePartBeforeEnded) {
  const MotionConfig config = SequenceOf({MovesConfig{.postures = {"power"}}, HoldConfig{}});
  const Motion motion = SynthesiseMotion(config, At1kHz());
  const auto power = PostureAngles(PostureIndex("power"));
  for (int c = 0; c < 18; ++c) {
    EXPECT_NEAR(motion.angle_rad(motion.angle_rad.rows() - 1, c), power[c], 1e-9);
  }
}

TEST(Sequence, HasSegmentsForItsLabelledPartsOnly) {
  const HoldConfig one_second{.duration_s = 1.0};
  const MotionConfig inner = {
      .settings = SequenceConfig{
          .parts = {{.settings = one_second, .label = "slow"}, {.settings = one_second}}}};
  MotionConfig config = {
      .settings = SequenceConfig{
          .parts = {{.settings = one_second}, {.settings = one_second, .label = "fast"}, inner}}};
  const Motion motion = SynthesiseMotion(config, At1kHz());
  ASSERT_EQ(motion.segments.size(), 2u);
  EXPECT_EQ(motion.segments[0].label, "fast");
  EXPECT_EQ(motion.segments[0].begin, 1000);
  EXPECT_EQ(motion.segments[0].end, 2000);
  EXPECT_EQ(motion.segments[1].label, "slow");
  EXPECT_EQ(motion.segments[1].begin, 2000);
  EXPECT_EQ(motion.segments[1].end, 3000);
  config.label = "rest";  // of the whole
  EXPECT_EQ(SynthesiseMotion(config, At1kHz()).segments.size(), 1u);
}

TEST(Sequence, GivesPartsOfTheSameKindDifferentRandomMotions) {
  const RandomMotionConfig random{.duration_s = 3.0};
  const Signal angle = SynthesiseMotion(SequenceOf({random, random}), At1kHz()).angle_rad;
  EXPECT_GT((angle.middleRows(1000, 1000) - angle.middleRows(4000, 1000)).cwiseAbs().maxCoeff(),
            0.1);
}

TEST(Tremor, LiesInItsBandAndHasItsSize) {
  TremorConfig config;
  config.rms_deg = 0.3;
  const Signal tremor = SynthesiseTremor(config, 200000, 1000.0, 4);
  double mean_square = 0.0;
  for (Eigen::Index c = 0; c < 18; ++c) {
    const auto power = PowerSpectrum(tremor.col(c) * kDegPerRad);
    const double all = PowerBetween(power, 0.0, 500.0, 200.0);
    EXPECT_GT(PowerBetween(power, 7.9, 12.1, 200.0) / all, 0.98);
    mean_square += all / 18.0;
  }
  // The shared half is one draw of eight sines that beat with each other: 5 % over 200 s.
  EXPECT_NEAR(std::sqrt(mean_square), 0.3, 0.02);
}

TEST(Tremor, BelongsToTheTruthOnlyIfSaid) {
  GloveConfig config;
  config.motion.settings = HoldConfig{};
  config.tremor.rms_deg = 1.0;
  const GloveSignal without = SynthesiseGlove(config, 1);
  config.tremor.belongs_to_truth = true;
  const GloveSignal with = SynthesiseGlove(config, 1);
  EXPECT_EQ(with.counts, without.counts);  // the glove measures it in any case
  EXPECT_EQ((without.true_angle_rad.rowwise() - without.true_angle_rad.row(0)).norm(), 0.0);
  EXPECT_LT((with.true_angle_rad - without.true_angle_rad - with.tremor_rad).norm(), 1e-9);
}

TEST(MotionKinds, ExplainThemselves) {
  EXPECT_EQ(MotionKinds().size(), 10u);
  for (const MotionKind& kind : MotionKinds()) {
    EXPECT_FALSE(kind.summary.empty()) << kind.name;
    EXPECT_EQ(kind.defaults.kind(), kind.name);
  }
  EXPECT_EQ(MotionConfig{}.kind(), "random");
}

}  // namespace
}  // namespace gauntlet::sim
