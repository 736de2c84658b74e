#include <gtest/gtest.h>

#include <cmath>

#include "sim/base/channels.h"
#include "sim/glove/sensor/bend_sensor.h"

namespace gauntlet::sim {
namespace {

// 10 to 90 % is 100 to 900 counts.
const std::vector<controller::ConverterRange> kConverters(18, {.full_scale_counts = 1000.0});

SensorConfig Nominal() {
  SensorConfig config;
  config.gain_deviation_percent = config.offset_deviation_percent = 0.0;
  config.curvature_deviation_percent = config.cross_talk_percent = 0.0;
  config.hysteresis_deg = 0.0;
  return config;
}

/// All channels at this share of their range, sample by sample.
Signal AnglesAt(const std::vector<double>& shares) {
  Signal angle_rad(static_cast<Eigen::Index>(shares.size()), 18);
  for (Eigen::Index i = 0; i < angle_rad.rows(); ++i) {
    for (Eigen::Index c = 0; c < 18; ++c) {
      const Channel& joint = GloveChannels()[static_cast<std::size_t>(c)];
      angle_rad(i, c) = kRadPerDeg * (joint.min_deg + shares[static_cast<std::size_t>(i)] *
                                                          (joint.max_deg - joint.min_deg));
    }
  }
  return angle_rad;
}

Signal Sense(const SensorConfig& config, const SensorParameters& sensor,
             const std::vector<double>& shares) {
  return SenseBend(config, sensor, AnglesAt(shares), 1000.0, kConverters);
}

TEST(BendSensor, MapsTheRangeToTenToNinetyPercent) {
  const Signal counts = Sense(Nominal(), NominalSensor(), {0.0, 0.5, 1.0});
  for (int c = 0; c < 18; ++c) {
    EXPECT_NEAR(counts(0, c), 100.0, 1e-9);
    EXPECT_NEAR(counts(1, c), 500.0, 1e-9);
    EXPECT_NEAR(counts(2, c), 900.0, 1e-9);
  }
}

TEST(BendSensor, AppliesGainAboutTheMiddleOffsetAndCurvature) {
  SensorParameters sensor = NominalSensor();
  sensor.gain[3] = 1.1;
  sensor.offset_share[4] = 0.02;
  sensor.curvature_share[5] = 0.05;
  const Signal counts = Sense(Nominal(), sensor, {0.0, 0.5, 1.0});
  EXPECT_NEAR(counts(0, 3), 60.0, 1e-9);
  EXPECT_NEAR(counts(1, 3), 500.0, 1e-9);
  EXPECT_NEAR(counts(2, 3), 940.0, 1e-9);
  EXPECT_NEAR(counts(1, 4), 520.0, 1e-9);
  EXPECT_NEAR(counts(0, 5), 100.0, 1e-9);  // the bow touches both ends
  EXPECT_NEAR(counts(1, 5), 540.0, 1e-9);
  EXPECT_NEAR(counts(2, 5), 900.0, 1e-9);
}

TEST(BendSensor, LagsByItsTimeConstant) {
  SensorConfig config = Nominal();
  config.lag_ms = 20.0;
  std::vector<double> step(200, 1.0);
  step[0] = 0.0;
  const Signal counts = Sense(config, NominalSensor(), step);
  // 63.2 % of the step of 800 counts after one time constant.
  EXPECT_NEAR(counts(20, 0), 100.0 + 800.0 * (1.0 - std::exp(-1.0)), 1e-6);
}

TEST(BendSensor, KeepsBackHalfThePlayOnEitherWay) {
  SensorConfig config = Nominal();
  config.hysteresis_deg = 10.0;  // of the 100 deg of index_pip: 80 counts
  const Signal counts = Sense(config, NominalSensor(), {0.0, 0.5, 0.46, 0.5, 0.2, 0.24});
  const int c = ChannelIndex("index_pip");
  EXPECT_NEAR(counts(0, c), 100.0, 1e-9);
  EXPECT_NEAR(counts(1, c), 460.0, 1e-9);
  EXPECT_NEAR(counts(2, c), 460.0, 1e-9);  // inside the play nothing moves
  EXPECT_NEAR(counts(3, c), 460.0, 1e-9);
  EXPECT_NEAR(counts(4, c), 300.0, 1e-9);
  EXPECT_NEAR(counts(5, c), 300.0, 1e-9);
}

TEST(BendSensor, SeesSomeOfItsNeighboursBending) {
  SensorParameters sensor = NominalSensor();
  sensor.cross_talk = {{4, 5, 0.1}, {5, 6, 0.1}};
  Signal angle_rad = AnglesAt(std::vector<double>(1500, 0.5));
  const auto share = [](const Channel& j, double s) {
    return kRadPerDeg * (j.min_deg + s * (j.max_deg - j.min_deg));
  };
  angle_rad.col(4).setConstant(share(GloveChannels()[4], 0.8));
  const Signal counts = SenseBend(Nominal(), sensor, angle_rad, 1000.0, kConverters);
  for (const int i : {0, 511, 512, 1499}) {
    EXPECT_NEAR(counts(i, 5), 500.0 + 0.1 * 0.3 * 800.0, 1e-9);
    // What 5 sees of 4 is not passed on to 6: cross-talk is of the bending, not of the signal.
    EXPECT_NEAR(counts(i, 6), 500.0, 1e-9);
  }
}

TEST(BendSensor, DriftsTowardsItsWarmOffset) {
  SensorConfig config = Nominal();
  config.drift_time_s = 1.0;
  SensorParameters sensor = NominalSensor();
  sensor.drift_share[2] = 0.03;
  const Signal counts = Sense(config, sensor, std::vector<double>(5001, 0.5));
  EXPECT_NEAR(counts(0, 2), 500.0, 1e-9);
  EXPECT_NEAR(counts(1000, 2), 500.0 + 30.0 * (1.0 - std::exp(-1.0)), 1e-9);
  EXPECT_NEAR(counts(5000, 2), 530.0, 0.25);
}

TEST(BendSensor, DrawsDeviationsWithTheStatedSpread) {
  SensorConfig config;
  config.gain_deviation_percent = 4.0;
  config.curvature_deviation_percent = 2.0;
  double gain = 0.0, curvature = 0.0, product = 0.0;
  constexpr int kGloves = 200;
  for (int seed = 0; seed < kGloves; ++seed) {
    const SensorParameters sensor = DrawSensor(config, seed);
    for (int c = 0; c < 18; ++c) {
      gain += std::pow(sensor.gain[c] - 1.0, 2) / kGloves / 18;
      curvature += std::pow(sensor.curvature_share[c], 2) / kGloves / 18;
      product += (sensor.gain[c] - 1.0) * sensor.curvature_share[c] / kGloves / 18;
    }
  }
  // 3,600 draws: the standard error of a deviation is 1.2 % of it.
  EXPECT_NEAR(std::sqrt(gain), 0.04, 3.9 * 0.012 * 0.04);
  EXPECT_NEAR(std::sqrt(curvature), 0.02, 3.9 * 0.012 * 0.02);
  EXPECT_LT(std::abs(product), 3.9 * 0.04 * 0.02 / 60.0);
}

TEST(BendSensor, DrawsPlayAndLagAboutTheirMedians) {
  const SensorConfig config;
  double play = 0.0, lag = 0.0, play_squares = 0.0, lag_squares = 0.0;
  constexpr int kGloves = 200;
  for (int seed = 0; seed < kGloves; ++seed) {
    const SensorParameters sensor = DrawSensor(config, seed);
    for (int c = 0; c < 18; ++c) {
      const double play_log = std::log(sensor.hysteresis_scale[c]);
      const double lag_log = std::log(sensor.lag_scale[c]);
      play += play_log / kGloves / 18;
      lag += lag_log / kGloves / 18;
      play_squares += play_log * play_log / kGloves / 18;
      lag_squares += lag_log * lag_log / kGloves / 18;
    }
  }
  // 3,600 draws: standard errors of 1/60 for a mean and 1.2 % for a deviation, in deviations.
  EXPECT_NEAR(play, 0.0, 3.9 * 0.2 / 60.0);
  EXPECT_NEAR(lag, 0.0, 3.9 * 0.2 / 60.0);
  EXPECT_NEAR(std::sqrt(play_squares), 0.2, 3.9 * 0.012 * 0.2);
  EXPECT_NEAR(std::sqrt(lag_squares), 0.2, 3.9 * 0.012 * 0.2);
}

TEST(BendSensor, ScalesPlayAndLagByChannel) {
  SensorConfig config = Nominal();
  config.hysteresis_deg = 10.0;
  SensorParameters sensor = NominalSensor();
  const int c = ChannelIndex("index_pip");  // 100 deg: 8 counts per degree
  sensor.hysteresis_scale[static_cast<std::size_t>(c)] = 2.0;
  EXPECT_NEAR(Sense(config, sensor, {0.0, 0.5})(1, c), 420.0, 1e-9);
  EXPECT_NEAR(Sense(config, sensor, {0.0, 0.5})(1, ChannelIndex("middle_pip")), 460.0, 1e-9);

  config.hysteresis_deg = 0.0;
  config.lag_ms = 20.0;
  sensor.lag_scale[static_cast<std::size_t>(c)] = 0.5;
  std::vector<double> step(200, 1.0);
  step[0] = 0.0;
  EXPECT_NEAR(Sense(config, sensor, step)(10, c), 100.0 + 800.0 * (1.0 - std::exp(-1.0)), 1e-6);
}

TEST(BendSensor, WithDefaultsIsWrongByAboutThreeDegreesAtMost) {
  const SensorConfig config;
  const std::vector<double> shares = {0.2, 0.4, 0.6, 0.8};
  const Signal nominal = Sense(Nominal(), NominalSensor(), shares);
  double worst_deg = 0.0;
  for (int c = 0; c < 18; ++c) {
    double squares = 0.0;
    for (int seed = 0; seed < 100; ++seed) {
      const Signal counts = Sense(config, DrawSensor(config, seed), shares);
      squares += (counts - nominal).col(c).squaredNorm() / 400.0;
    }
    const Channel& joint = GloveChannels()[static_cast<std::size_t>(c)];
    worst_deg = std::max(worst_deg, std::sqrt(squares) / 800.0 * (joint.max_deg - joint.min_deg));
  }
  EXPECT_GT(worst_deg, 1.0);
  EXPECT_LT(worst_deg, 4.0);
}

}  // namespace
}  // namespace gauntlet::sim
