#include "sim/glove/glove.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "sim/base/channels.h"
#include "sim/base/error.h"
#include "sim/base/timing.h"
#include "sim/glove/noise/add_noise.h"
#include "sim/glove/sensor/bend_sensor.h"

namespace gauntlet::sim {
namespace {

void ConvertAll(double full_scale_counts, Signal& counts) {
  for (Eigen::Index c = 0; c < counts.cols(); ++c) {
    // NaN, a missing sample of a recording, passes through.
    for (double& value : counts.col(c)) {
      if (!std::isnan(value)) value = Convert(value, full_scale_counts);
    }
    TrimSignals();
  }
}

/// Of what has a channel by itself, likewise.
template <class Part>
void KeepOfChannels(const std::vector<int>& indices, std::vector<Part>& parts) {
  std::vector<Part> kept;
  for (Part part : parts) {
    const auto place = std::ranges::find(indices, part.channel);
    if (place == indices.end()) continue;
    part.channel = static_cast<int>(place - indices.begin());
    kept.push_back(part);
  }
  parts = std::move(kept);
}

/// Keeps the channels that the glove has, in its order, everywhere.
void KeepChannels(const std::vector<int>& indices, GloveSignal& glove) {
  glove.true_angle_rad = glove.true_angle_rad(Eigen::all, indices);
  glove.counts = glove.counts(Eigen::all, indices);
  if (glove.tremor_rad.size() > 0) glove.tremor_rad = glove.tremor_rad(Eigen::all, indices);
  KeepOfChannels(indices, glove.faults);
  KeepOfChannels(indices, glove.masked);
}

/// The analog signal of all channels before noise, at every tick [counts].
Signal Sense(const GloveConfig& config, const Motion& motion, const Signal& tremor_rad,
             double tick_rate_hz, std::uint64_t seed) {
  const double full_scale = config.converter.full_scale_counts();
  // A recorded glove has gone through its own sensors already.
  if (motion.measured_rad.size() > 0) {
    return SenseBendNominal(config.sensor, motion.measured_rad, full_scale);
  }
  const SensorParameters sensor = DrawSensor(config.sensor, seed);
  if (tremor_rad.size() == 0) {
    return SenseBend(config.sensor, sensor, motion.angle_rad, tick_rate_hz, full_scale);
  }
  return SenseBend(config.sensor, sensor, motion.angle_rad + tremor_rad, tick_rate_hz, full_scale);
}

/// What the glove takes of a signal that has a row per tick.
Signal Sampled(Signal signal, int ticks_per_sample) {
  if (ticks_per_sample == 1) return signal;
  return EveryRow(signal, ticks_per_sample);
}

/// From the sensors' signal to what the glove says: faults of each stage, noise, converter.
void Digitise(const GloveConfig& config, std::uint64_t seed, GloveSignal& glove) {
  const double full_scale = config.converter.full_scale_counts();
  const auto apply_faults = [&](FaultStage stage) {
    ApplyFaults(stage, config.faults, full_scale, config.rate_hz, seed, glove.counts);
  };
  apply_faults(FaultStage::kSampling);
  AddNoise(config.noise, config.sensor, config.converter, config.rate_hz, seed, glove.counts,
           glove.remarks);
  apply_faults(FaultStage::kAnalog);
  ConvertAll(full_scale, glove.counts);
  apply_faults(FaultStage::kDigital);
}

void AddRemarksOnFaults(const GloveConfig& config, int samples, std::vector<std::string>& remarks) {
  for (std::size_t i = 0; i < config.faults.size(); ++i) {
    const double start_s = config.faults[i].when().start_s;
    const double end_s = samples / config.rate_hz;
    if (start_s < end_s) continue;
    remarks.push_back(
        fmt::format("glove.faults[{}]: {} never comes: start_s is {}, the motion ends "
                    "at {} s",
                    i, config.faults[i].kind(), start_s, end_s));
  }
}

}  // namespace

std::vector<int> ChannelsOf(const GloveConfig& config) {
  SelectChannels(config.channels);  // refuses names that there are not
  std::vector<int> indices;
  for (const std::string& name : config.channels.empty() ? GloveChannelNames() : config.channels) {
    indices.push_back(ChannelIndex(name));
    if (std::ranges::count(indices, indices.back()) > 1) {
      throw controller::SettingError("channels", "names " + name + " twice");
    }
  }
  return indices;
}

GloveSignal SynthesiseGlove(const GloveConfig& config, std::uint64_t seed) {
  controller::CheckSettings(config);
  config.noise.Check();
  const std::vector<int> indices = ChannelsOf(config);

  const controller::Timing timing = MakeGloveTiming(config.rate_hz);
  Motion motion = controller::WithinSetting("motion", [&] {
    return SynthesiseMotion(config.motion, {.rate_hz = timing.tick_rate_hz,
                                            .seed = seed,
                                            .start_rad = {},
                                            .sensor = config.sensor,
                                            .converter = config.converter});
  });
  const auto ticks = static_cast<int>(motion.angle_rad.rows());
  GloveSignal glove;
  glove.rate_hz = config.rate_hz;
  glove.tick_rate_hz = timing.tick_rate_hz;
  glove.ticks_per_sample = timing.ticks_per_sample;
  for (const int c : indices) {
    glove.channel_names.emplace_back(KnownChannels()[static_cast<std::size_t>(c)].name);
  }
  glove.tremor_rad = controller::WithinSetting(
      "tremor", [&] { return SynthesiseTremor(config.tremor, ticks, timing.tick_rate_hz, seed); });
  glove.is_recorded = motion.measured_rad.size() > 0;
  glove.counts = Sampled(Sense(config, motion, glove.tremor_rad, timing.tick_rate_hz, seed),
                         timing.ticks_per_sample);
  const auto samples = static_cast<int>(glove.counts.rows());
  glove.true_angle_rad = std::move(motion.angle_rad);
  if (glove.tremor_rad.size() > 0 && config.tremor.belongs_to_truth) {
    for (Eigen::Index c = 0; c < glove.tremor_rad.cols(); ++c) {
      glove.true_angle_rad.col(c) += glove.tremor_rad.col(c);
      TrimSignals();
    }
  }
  glove.segments = std::move(motion.segments);
  glove.masked = std::move(motion.masked);
  glove.recording = std::move(motion.recording);
  glove.recording_start_s = motion.recording_start_s;
  glove.reference_name = std::move(motion.reference_name);
  glove.remarks = std::move(motion.remarks);

  glove.faults = DrawFaults(config.faults, samples, config.rate_hz, seed);
  Digitise(config, seed, glove);
  AddRemarksOnFaults(config, samples, glove.remarks);
  KeepChannels(indices, glove);
  return glove;
}

GloveConfig WithoutNoise(GloveConfig config) {
  config.noise = {};
  config.noise.kind = WhiteNoiseKind::kNone;
  config.faults.clear();
  return config;
}

bool IsWithoutNoise(const GloveConfig& config) {
  const bool recorded = !config.noise.recording.empty() && config.noise.recording_scale > 0.0;
  return config.faults.empty() && !recorded && config.noise.walk_counts_per_sqrt_s == 0.0 &&
         std::ranges::all_of(NoiseVarianceCounts2(config), [](double v) { return v == 0.0; });
}

std::vector<double> NoiseVarianceCounts2(const GloveConfig& config) {
  std::vector<double> variances;
  for (const int c : ChannelsOf(config)) {
    variances.push_back(VarianceOfNoise(config.noise, config.converter, c));
  }
  return variances;
}

std::vector<double> NoiseVarianceRad2(const GloveConfig& config) {
  const controller::GloveCalibration glove = NominalCalibration(config);
  std::vector<double> variances = NoiseVarianceCounts2(config);
  for (std::size_t i = 0; i < variances.size(); ++i) {
    const double rad_per_count = (glove.high_angle_rad[i] - glove.low_angle_rad[i]) /
                                 (glove.high_counts[i] - glove.low_counts[i]);
    variances[i] *= rad_per_count * rad_per_count;
  }
  return variances;
}

controller::GloveCalibration NominalCalibration(const GloveConfig& config) {
  controller::GloveCalibration calibration;
  calibration.full_scale_counts = config.converter.full_scale_counts();
  for (const int c : ChannelsOf(config)) {
    const Channel& channel = KnownChannels()[static_cast<std::size_t>(c)];
    calibration.channel_names.emplace_back(channel.name);
    calibration.low_angle_rad.push_back(channel.min_deg * kRadPerDeg);
    calibration.high_angle_rad.push_back(channel.max_deg * kRadPerDeg);
    calibration.low_counts.push_back(config.sensor.low_counts(calibration.full_scale_counts));
    calibration.high_counts.push_back(config.sensor.high_counts(calibration.full_scale_counts));
  }
  return calibration;
}

}  // namespace gauntlet::sim
