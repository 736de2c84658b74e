#include "sim/glove/glove.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <string>
#include <string_view>
#include <thread>
#include <tuple>
#include <utility>
#include <vector>

#include "sim/base/channels.h"
#include "sim/base/error.h"
#include "sim/glove/faults/fault_config.h"
#include "tests/support/source_dir.h"

namespace gauntlet::sim {
namespace {

using ::testing::HasSubstr;

GloveConfig HoldStill(double duration_s) {
  GloveConfig config;
  config.motion.settings = HoldConfig{.duration_s = duration_s};
  return config;
}

void MakeNominal(SensorConfig& sensor) {
  sensor.gain_deviation_percent = 0.0;
  sensor.offset_deviation_percent = 0.0;
  sensor.curvature_deviation_percent = 0.0;
  sensor.cross_talk_percent = 0.0;
  sensor.hysteresis_deg = 0.0;
}

TEST(Channels, AreEighteenAndKnownByName) {
  EXPECT_EQ(GloveChannels().size(), 18u);
  EXPECT_EQ(ChannelIndex("thumb_rotation"), 0);
  EXPECT_EQ(ChannelIndex("shoulder_flexion"), 17);
  EXPECT_THROW(ChannelIndex("tail"), UserError);
}

TEST(Glove, SameSeedGivesTheSameBytesAndAnotherSeedOthers) {
  GloveConfig config;
  config.motion.settings = RandomMotionConfig{.duration_s = 1.0};
  const GloveSignal first = SynthesiseGlove(config, 7);
  const GloveSignal second = SynthesiseGlove(config, 7);
  const GloveSignal other = SynthesiseGlove(config, 8);
  EXPECT_EQ(first.counts, second.counts);
  EXPECT_EQ(first.true_angle_rad, second.true_angle_rad);
  EXPECT_NE(first.counts, other.counts);
}

TEST(Glove, IsTheSameOnManyThreadsAtOnce) {
  GloveConfig config;
  config.motion.settings = RandomMotionConfig{.duration_s = 1.0};
  config.tremor.rms_deg = 0.2;
  config.noise.pink_variance_counts2 = 3.0;
  config.faults = {FaultConfig{}};
  const Signal alone = SynthesiseGlove(config, 7).counts;
  std::vector<Signal> together(4);
  std::vector<std::thread> threads;
  for (Signal& counts : together) {
    threads.emplace_back([&] { counts = SynthesiseGlove(config, 7).counts; });
  }
  for (std::thread& thread : threads) thread.join();
  for (const Signal& counts : together) EXPECT_EQ(counts, alone);
}

TEST(Glove, WithFewerChannelsGivesTheSameOfThose) {
  GloveConfig config;
  config.motion.settings = RandomMotionConfig{.duration_s = 1.0};
  config.faults = {FaultConfig{}};
  const GloveSignal all = SynthesiseGlove(config, 7);
  config.channels = {"elbow_flexion", "index_pip"};  // in the order in which it sends them
  const GloveSignal two = SynthesiseGlove(config, 7);
  EXPECT_EQ(two.channel_names, config.channels);
  EXPECT_EQ(two.counts.col(0), all.counts.col(ChannelIndex("elbow_flexion")));
  EXPECT_EQ(two.counts.col(1), all.counts.col(ChannelIndex("index_pip")));
  EXPECT_EQ(two.true_angle_rad.col(0), all.true_angle_rad.col(ChannelIndex("elbow_flexion")));
  EXPECT_EQ(NominalCalibration(config).channel_names, config.channels);
  const std::vector<double> variances = NoiseVarianceCounts2(GloveConfig{});
  EXPECT_EQ(NoiseVarianceCounts2(config), (std::vector{variances[ChannelIndex("elbow_flexion")],
                                                       variances[ChannelIndex("index_pip")]}));
}

TEST(Glove, CountsAreWholeAndInsideTheScale) {
  for (const int bits : {8, 10, 16}) {
    GloveConfig config;
    config.motion.settings = RandomMotionConfig{.duration_s = 2.0, .range_percent = 100.0};
    config.noise.variance_scale = 1000.0;  // enough to clip at both ends
    config.converter.bits = {static_cast<double>(bits)};
    const GloveSignal glove = SynthesiseGlove(config, 1);
    const double full_scale = std::pow(2.0, bits) - 1.0;
    EXPECT_EQ(glove.counts.minCoeff(), 0.0);
    EXPECT_EQ(glove.counts.maxCoeff(), full_scale);
    EXPECT_TRUE((glove.counts.array() == glove.counts.array().round()).all());
  }
}

/// Faults, noise that clips at both ends, and noise that channels have in common.
GloveConfig WithAllThatKnowsTheConverter() {
  GloveConfig config;
  config.motion.settings = RandomMotionConfig{.duration_s = 2.0, .range_percent = 100.0};
  config.noise.covariance_counts2.assign(18 * 18, 9000.0);
  for (std::size_t c = 0; c < 18; ++c) config.noise.covariance_counts2[19 * c] = 36000.0;
  for (const FaultKind& kind : FaultKinds()) config.faults.push_back(kind.defaults);
  return config;
}

TEST(Glove, SignedCountsAreThoseOfTheSameConverterLessAsMuch) {
  GloveConfig config = WithAllThatKnowsTheConverter();
  const GloveSignal from_zero = SynthesiseGlove(config, 1);
  EXPECT_EQ(NominalCalibration(config).min_counts, std::vector{0.0});
  config.converter.min_counts.assign(18, 0.0);
  for (std::size_t c = 1; c < 18; c += 2) config.converter.min_counts[c] = -512.0;
  const GloveSignal mixed = SynthesiseGlove(config, 1);
  const controller::GloveCalibration calibration = NominalCalibration(config);
  EXPECT_EQ(calibration.full_scale_counts[1], 511.0);
  int at_the_lower_end = 0;
  for (Eigen::Index c = 0; c < 18; ++c) {
    const double shift = c % 2 == 1 ? -512.0 : 0.0;
    EXPECT_EQ(calibration.min_counts[static_cast<std::size_t>(c)], shift);
    EXPECT_EQ(mixed.counts.col(c).array().isNaN().count(),
              from_zero.counts.col(c).array().isNaN().count());
    const auto differs = (mixed.counts.col(c).array() != from_zero.counts.col(c).array() + shift) &&
                         !mixed.counts.col(c).array().isNaN();
    EXPECT_EQ(differs.count(), 0) << c;
    at_the_lower_end += (mixed.counts.col(c).array() == shift).any() ? 1 : 0;
  }
  EXPECT_GE(at_the_lower_end, 14) << "others are disconnected";
}

TEST(Glove, AWiderConverterGivesTheSameVoltagesInMoreCounts) {
  GloveConfig config = WithAllThatKnowsTheConverter();
  config.converter.bits = {24.0};  // as good as no rounding
  const GloveSignal fine = SynthesiseGlove(config, 1);
  config.converter.bits.assign(18, 24.0);
  config.converter.bits[4] = 10.0;
  config.converter.bits[5] = 12.0;
  config.converter.min_counts.assign(18, 0.0);
  config.converter.min_counts[5] = -2048.0;
  const GloveSignal mixed = SynthesiseGlove(config, 1);
  for (Eigen::Index c = 0; c < 18; ++c) {
    const controller::ConverterRange range = config.converter.range(static_cast<std::size_t>(c));
    for (Eigen::Index k = 0; k < fine.counts.rows(); ++k) {
      const double exact =
          range.min_counts + fine.counts(k, c) * range.span_counts() / (std::exp2(24.0) - 1.0);
      if (std::isnan(exact)) continue;
      ASSERT_NEAR(mixed.counts(k, c), exact, 0.501) << c << ", " << k;
    }
  }
}

TEST(Glove, NominalCalibrationUndoesTheNominalSensorToHalfACount) {
  GloveConfig config;
  config.noise.kind = WhiteNoiseKind::kNone;
  MakeNominal(config.sensor);
  const GloveSignal glove = SynthesiseGlove(config, 3);
  const controller::GloveCalibration calibration = NominalCalibration(config);
  for (int channel = 0; channel < 18; ++channel) {
    const double rad_per_count =
        (calibration.high_angle_rad[channel] - calibration.low_angle_rad[channel]) /
        (calibration.high_counts[channel] - calibration.low_counts[channel]);
    const auto angle =
        calibration.low_angle_rad[channel] +
        rad_per_count * (glove.counts.col(channel).array() - calibration.low_counts[channel]);
    const double worst = (angle - glove.true_angle_rad.col(channel).array()).abs().maxCoeff();
    EXPECT_LE(worst, 0.5000001 * rad_per_count);
    EXPECT_GT(worst, 0.4 * rad_per_count);  // rounding is there
  }
}

TEST(Glove, DeviationsDifferFromGloveToGloveAsStated) {
  GloveConfig config = HoldStill(0.01);
  config.noise.kind = WhiteNoiseKind::kNone;
  MakeNominal(config.sensor);
  config.sensor.offset_deviation_percent = 3.0;
  double sum = 0.0, squares = 0.0;
  constexpr int kGloves = 400;
  for (int seed = 0; seed < kGloves; ++seed) {
    const double counts = SynthesiseGlove(config, seed).counts(0, 0);
    sum += counts;
    squares += counts * counts;
  }
  const double deviation = std::sqrt(squares / kGloves - sum * sum / kGloves / kGloves);
  // 3 % of 1023 counts; the standard error of a deviation of 400 draws is 3.5 % of it.
  EXPECT_NEAR(deviation, 30.69, 3.9 * 0.035 * 30.69);
}

TEST(Glove, NoiseHasThePapersVarianceInEachChannel) {
  GloveConfig config = HoldStill(40.0);
  const GloveSignal glove = SynthesiseGlove(config, 5);
  for (int channel = 0; channel < 18; ++channel) {
    const auto column = glove.counts.col(channel).array();
    const double variance = (column - column.mean()).square().mean();
    // Rounding adds 1/12; the standard error of a variance of 40,000 draws is 0.7 %.
    const double expected = kPaperVarianceCounts2[channel] + 1.0 / 12.0;
    EXPECT_NEAR(variance, expected, 3.9 * 0.00708 * expected) << channel;
  }
}

TEST(Glove, HoldsStillWhenTold) {
  const GloveSignal glove = SynthesiseGlove(HoldStill(1.0), 1);
  EXPECT_EQ(glove.true_angle_rad.rows(), 1000);
  EXPECT_EQ(glove.true_angle_rad.row(0), glove.true_angle_rad.row(999));
}

TEST(Glove, RandomMotionStaysInsideItsRangeAndUsesIt) {
  GloveConfig config;
  config.motion.settings = RandomMotionConfig{.duration_s = 60.0, .range_percent = 50.0};
  const Signal angle_deg = SynthesiseGlove(config, 2).true_angle_rad * kDegPerRad;
  // Where the thumb meets no finger.
  const std::map<std::string_view, std::pair<double, double>> clear = {
      {"thumb_rotation", {0, 45}}, {"thumb_abduction", {45, 60}}, {"thumb_mcp", {0, 30}}};
  for (int channel = 0; channel < 18; ++channel) {
    auto [name, min_deg, max_deg, help] = GloveChannels()[channel];
    if (const auto part = clear.find(name); part != clear.end()) {
      std::tie(min_deg, max_deg) = part->second;
    }
    const double range = max_deg - min_deg;
    EXPECT_GE(angle_deg.col(channel).minCoeff(), min_deg + 0.25 * range) << name;
    EXPECT_LE(angle_deg.col(channel).maxCoeff(), max_deg - 0.25 * range) << name;
    EXPECT_GT(angle_deg.col(channel).maxCoeff() - angle_deg.col(channel).minCoeff(), 0.3 * range);
  }
}

TEST(Glove, PlaysTheDoorRecordingAtOneKilohertz) {
  GloveConfig config;
  RecordedMotionConfig recording = {.file = SourceDir() +
                                            "/scenarios/recordings/door_opening/angles.csv"};
  config.motion.settings = recording;
  const GloveSignal whole = SynthesiseGlove(config, 1);
  recording.start_s = 2.0;
  recording.duration_s = 3.0;
  config.motion.settings = recording;
  const GloveSignal part = SynthesiseGlove(config, 1);
  EXPECT_EQ(whole.true_angle_rad.rows(), 10841);
  EXPECT_EQ(part.true_angle_rad.rows(), 3000);
  EXPECT_LT(
      (part.true_angle_rad - whole.true_angle_rad.middleRows(2000, 3000)).cwiseAbs().maxCoeff(),
      1e-9);
  EXPECT_EQ(whole.reference_name, "ground truth");
}

TEST(Glove, NamesTheSettingThatIsWrong) {
  GloveConfig config = HoldStill(1.0);
  config.converter.bits = {7};
  EXPECT_THROW(SynthesiseGlove(config, 1), controller::SettingError);
  config = HoldStill(1.0);
  config.converter.bits = {10.0, 12.0};
  EXPECT_THROW(SynthesiseGlove(config, 1), controller::SettingError);
  config.converter.bits = {10.0};
  config.converter.min_counts = {0.5};
  EXPECT_THROW(SynthesiseGlove(config, 1), controller::SettingError);
  config = HoldStill(1.0);
  config.noise.variance_counts2 = {1.0, 2.0};
  try {
    SynthesiseGlove(config, 1);
    FAIL();
  } catch (const controller::SettingError& error) {
    EXPECT_THAT(error.what(), HasSubstr("noise.variance_counts2: has 2 values, must have 1 or 18"));
  }
}

/// All that draws at random, and faults.
GloveConfig RestlessGlove() {
  GloveConfig config;
  config.rate_hz = 120.0;
  config.motion.settings = RandomMotionConfig{.duration_s = 0.6};
  config.tremor.rms_deg = 2.0;
  config.sensor.drift_deviation_percent = 5.0;
  config.noise.pink_variance_counts2 = 30.0;
  config.faults.resize(1);
  return config;
}

TEST(Glove, WithoutNoiseAllElseIsTheSame) {
  const GloveConfig noisy = RestlessGlove();
  const GloveConfig quiet = WithoutNoise(noisy);
  EXPECT_FALSE(IsWithoutNoise(noisy));
  EXPECT_TRUE(IsWithoutNoise(quiet));
  for (const std::uint64_t seed : {1, 2}) {
    const GloveSignal with = SynthesiseGlove(noisy, seed);
    const GloveSignal without = SynthesiseGlove(quiet, seed);
    EXPECT_EQ(with.true_angle_rad, without.true_angle_rad);
    EXPECT_EQ(with.tremor_rad, without.tremor_rad);
    EXPECT_NE(with.counts, without.counts);
    EXPECT_TRUE(without.faults.empty());
  }
  // The deviations of its sensors remain: another seed is another glove on the same still hand.
  GloveConfig still = quiet;
  still.motion.settings = HoldConfig{.duration_s = 0.2};
  EXPECT_NE(SynthesiseGlove(still, 1).counts, SynthesiseGlove(still, 2).counts);
  EXPECT_EQ(SynthesiseGlove(still, 1).true_angle_rad, SynthesiseGlove(still, 2).true_angle_rad);
}

TEST(Glove, IsWithoutNoiseWhereEveryKindOfItIsNothing) {
  const auto with = [](auto change) {
    GloveConfig config = WithoutNoise(RestlessGlove());
    change(config);
    return IsWithoutNoise(config);
  };
  EXPECT_FALSE(with([](GloveConfig& c) { c.noise.kind = WhiteNoiseKind::kGalton; }));
  EXPECT_TRUE(with([](GloveConfig& c) {
    c.noise.kind = WhiteNoiseKind::kBoxMuller;
    c.noise.variance_scale = 0.0;
  }));
  EXPECT_FALSE(with([](GloveConfig& c) { c.noise.pink_variance_counts2 = 0.1; }));
  EXPECT_FALSE(with([](GloveConfig& c) { c.noise.mains_amplitude_counts = 0.1; }));
  EXPECT_FALSE(with([](GloveConfig& c) { c.faults.resize(1); }));
}

}  // namespace
}  // namespace gauntlet::sim
