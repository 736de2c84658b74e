#include "sim/glove/glove.h"

#include <cmath>

#include "sim/base/random.h"
#include "sim/glove/channels.h"
#include "sim/glove/noise/box_muller.h"
#include "sim/glove/sensor/bend_sensor.h"

namespace gauntlet::sim {
namespace {

// The full scale in whose counts the noise is given, see NoiseConfig.
constexpr double kNoiseFullScaleCounts = 1023.0;

std::span<double> Column(Signal& signal, Eigen::Index channel) {
  return {signal.col(channel).data(), static_cast<std::size_t>(signal.rows())};
}

void AddNoise(const NoiseConfig& config, double full_scale_counts, std::uint64_t seed,
              Signal& counts) {
  if (config.kind == WhiteNoiseKind::kNone) return;
  const double scale = full_scale_counts / kNoiseFullScaleCounts;
  for (Eigen::Index channel = 0; channel < counts.cols(); ++channel) {
    RandomStream random(seed, "noise/white", static_cast<std::uint64_t>(channel));
    const double deviation = scale * std::sqrt(config.VarianceCounts2(static_cast<int>(channel)));
    AddBoxMuller(random, deviation, Column(counts, channel));
  }
}

void ConvertAll(double full_scale_counts, Signal& counts) {
  for (double& value : counts.reshaped()) value = Convert(value, full_scale_counts);
}

void CheckChannelCount(const NoiseConfig& config) {
  const std::size_t count = config.variance_counts2.size();
  if (count > 1 && count != GloveChannels().size()) {
    throw controller::SettingError("noise.variance_counts2",
                                   "has " + std::to_string(count) + " values, must have 1 or 18");
  }
}

}  // namespace

GloveSignal SynthesiseGlove(const GloveConfig& config, std::uint64_t seed) {
  controller::CheckSettings(config);
  CheckChannelCount(config.noise);
  const double full_scale = config.converter.full_scale_counts();
  GloveSignal glove;
  glove.channel_names = GloveChannelNames();
  glove.rate_hz = config.rate_hz;
  glove.reference_name = "ground truth";
  Motion motion = SynthesiseMotion(config.motion, config.rate_hz, seed);
  glove.true_angle_rad = std::move(motion.angle_rad);
  glove.segments = std::move(motion.segments);
  glove.counts =
      SenseBend(config.sensor, DrawSensor(config.sensor, seed), glove.true_angle_rad, full_scale);
  AddNoise(config.noise, full_scale, seed, glove.counts);
  ConvertAll(full_scale, glove.counts);
  return glove;
}

controller::GloveCalibration NominalCalibration(const GloveConfig& config) {
  controller::GloveCalibration calibration;
  calibration.full_scale_counts = config.converter.full_scale_counts();
  for (const Channel& channel : GloveChannels()) {
    calibration.low_angle_rad.push_back(channel.min_deg * kRadPerDeg);
    calibration.high_angle_rad.push_back(channel.max_deg * kRadPerDeg);
    calibration.low_counts.push_back(0.01 * config.sensor.low_percent *
                                     calibration.full_scale_counts);
    calibration.high_counts.push_back(0.01 * config.sensor.high_percent *
                                      calibration.full_scale_counts);
  }
  return calibration;
}

}  // namespace gauntlet::sim
