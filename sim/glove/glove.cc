#include "sim/glove/glove.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <variant>

#include "sim/base/channels.h"
#include "sim/base/error.h"
#include "sim/base/nearest_name.h"
#include "sim/base/timing.h"
#include "sim/glove/noise/add_noise.h"
#include "sim/glove/sensor/bend_sensor.h"
#include "sim/recordings/column_scale.h"
#include "sim/recordings/recording.h"

namespace gauntlet::sim {
namespace {

void ConvertAll(const ConverterConfig& converter, Signal& counts) {
  for (Eigen::Index c = 0; c < counts.cols(); ++c) {
    const controller::ConverterRange range = converter.range(static_cast<std::size_t>(c));
    // NaN, a missing sample of a recording, passes through.
    for (double& value : counts.col(c)) {
      if (!std::isnan(value)) value = Convert(value, range);
    }
    TrimSignals();
  }
}

/// Keeps the parts that belong to these channels, each with the new number of its channel.
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

/// Replaces the counts of the nominal sensor by those of the recorded glove, where its calibration
/// is known. Errors: UserError for counts that its converter does not give.
void PutOwnCounts(const GloveConfig& config, const Motion& motion, Signal& counts) {
  constexpr double kMostBeyond = 0.05;
  for (const OwnCalibration& own : config.calibration) {
    const int c = ChannelIndex(own.channel);
    const auto [least, most] = config.converter.range(static_cast<std::size_t>(c));
    const double slope =
        (own.high_deg - own.low_deg) * kRadPerDeg / (own.high_counts - own.low_counts);
    ColumnScale scale{.factor = slope,
                      .offset_rad = own.low_deg * kRadPerDeg - own.low_counts * slope};
    for (const OwnCounts& recorded : motion.recording->own_counts) {
      if (recorded.channel == c) scale = recorded.scale;
    }
    auto column = counts.col(c).array();
    column = (motion.measured_rad.col(c).array() - scale.offset_rad) / scale.factor;
    TrimSignals();
    const auto beyond = ((column < least - 0.5) || (column > most + 0.5)).count();
    if (static_cast<double>(beyond) <= kMostBeyond * static_cast<double>(counts.rows())) continue;
    throw UserError(
        {.place = motion.recording->name,
         .problem = fmt::format(
             "{}: {:.0f} % of its counts are outside {:g} to {:g}; {}", own.channel,
             100.0 * static_cast<double>(beyond) / static_cast<double>(counts.rows()), least, most,
             (column < least - 0.5).any()
                 ? "signed counts need glove.converter.min_counts below 0"
                 : "bits in the column map, or glove.converter.bits, must be larger")});
  }
}

/// The analog signal of all channels before noise, at every tick [counts].
Signal Sense(const GloveConfig& config, const Motion& motion, const Signal& tremor_rad,
             double tick_rate_hz, std::uint64_t seed) {
  const std::vector<controller::ConverterRange> converters = config.converter.ranges();
  // A recorded glove has gone through its own sensors already.
  if (motion.measured_rad.size() > 0) {
    Signal counts = SenseBendNominal(motion.measured_rad, converters);
    PutOwnCounts(config, motion, counts);
    return counts;
  }
  if (!config.calibration.empty()) {
    throw controller::SettingError("calibration", "is for a recording with use: measured alone");
  }
  const SensorParameters sensor = DrawSensor(config.sensor, seed);
  if (tremor_rad.size() == 0) {
    return SenseBend(config.sensor, sensor, motion.angle_rad, tick_rate_hz, converters);
  }
  return SenseBend(config.sensor, sensor, motion.angle_rad + tremor_rad, tick_rate_hz, converters);
}

/// Samples that the glove takes of a signal that has a row per tick.
Signal Sampled(Signal signal, int ticks_per_sample) {
  if (ticks_per_sample == 1) return signal;
  return EveryRow(signal, ticks_per_sample);
}

/// From the sensors' signal to what the glove says: faults of each stage, noise, converter.
void Digitise(const GloveConfig& config, std::uint64_t seed, GloveSignal& glove) {
  const auto apply_faults = [&](FaultStage stage) {
    ApplyFaults(stage, config.faults, config.converter.ranges(), config.rate_hz, seed,
                glove.counts);
  };
  apply_faults(FaultStage::kSampling);
  AddNoise(config.noise, config.converter, config.rate_hz, seed, glove.counts);
  apply_faults(FaultStage::kAnalog);
  ConvertAll(config.converter, glove.counts);
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

/// One value for all, if there is only one.
std::vector<double> Shortened(const std::vector<double>& values) {
  const bool alike = std::ranges::all_of(values, [&](double v) { return v == values[0]; });
  return alike ? std::vector{values.at(0)} : values;
}

/// The bits of the converters of these columns. Columns whose bits are not in the map are of one
/// converter, which is as large as any of them needs, unless the settings have a list. Errors:
/// UserError if columns without bits of their own would become counts of another converter.
void ApplyBitsOfMap(const ColumnMap& map, const std::vector<OwnCounts>& columns,
                    const std::string& file, ConverterConfig& converter) {
  constexpr double kFewestBits = 8.0;
  std::vector<double> bits;
  for (std::size_t c = 0; c < KnownChannels().size(); ++c) bits.push_back(converter.bits_of(c));
  std::vector<bool> given(bits.size(), converter.bits.size() > 1);
  double most = kFewestBits;
  for (const OwnCounts& own : columns) {
    const auto c = static_cast<std::size_t>(own.channel);
    if (own.bits > 0) bits[c] = std::max<double>(own.bits, kFewestBits);
    given[c] = given[c] || own.bits > 0;
    const double above = std::max(own.low_counts, own.high_counts) - converter.range(c).min_counts;
    while (above > std::ldexp(1.0, static_cast<int>(bits[c])) - 1.0) ++bits[c];
    most = std::max(most, bits[c]);
  }
  for (const ColumnMapping& mapping : map.channels) {
    const bool stays = given[mapping.channel] || most == bits[mapping.channel];
    if (stays || mapping.unit != RecordedUnit::kCounts || mapping.bits > 0) continue;
    throw UserError(
        {.place = file,
         .problem = fmt::format("{}: bits must be given, as other columns are of {} bits",
                                KnownChannels()[mapping.channel].name, most)});
  }
  for (std::size_t c = 0; c < bits.size(); ++c) {
    if (!given[c]) bits[c] = most;
  }
  converter.bits = Shortened(bits);
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
  for (const OwnCalibration& own : config.calibration) {
    const std::vector<std::string> known = KnownChannelNames();
    if (std::ranges::count(config.calibration, own.channel, &OwnCalibration::channel) > 1 ||
        std::ranges::find(known, own.channel) == known.end()) {
      throw controller::SettingError("calibration", own.channel + " is no channel, or named twice" +
                                                        Suggestion(own.channel, known));
    }
  }
  return indices;
}

void ApplyCalibrationOfMap(GloveConfig& config) {
  const auto* motion = std::get_if<RecordedMotionConfig>(&config.motion.settings);
  if (motion == nullptr || motion->use != RecordingUse::kMeasured || motion->map.empty() ||
      !config.calibration.empty()) {
    return;
  }
  ColumnMap map;
  try {
    map = ReadMapOf(*motion);
    config.converter.Check();
  } catch (const UserError&) {
    return;
  } catch (const controller::SettingError&) {
    return;
  }
  const auto own_counts = [&] { return OwnCountsOf(map, NominalCountsOf(config.converter)); };
  if (own_counts().empty()) return;
  ApplyBitsOfMap(map, own_counts(), motion->map, config.converter);
  const auto rounded = [](double value) { return std::round(value * 1e9) / 1e9; };
  for (const OwnCounts& own : own_counts()) {
    const auto deg_at = [&](double counts) {
      return rounded((own.scale.factor * counts + own.scale.offset_rad) * kDegPerRad);
    };
    config.calibration.push_back(
        {.channel = std::string(KnownChannels()[static_cast<std::size_t>(own.channel)].name),
         .low_counts = rounded(own.low_counts),
         .high_counts = rounded(own.high_counts),
         .low_deg = deg_at(own.low_counts),
         .high_deg = deg_at(own.high_counts),
         .assumed = own.assumed});
  }
}

GloveSignal SynthesiseGlove(const GloveConfig& config, std::uint64_t seed) {
  controller::CheckSettings(config);
  config.noise.Check();
  config.converter.Check();
  const std::vector<int> indices = ChannelsOf(config);

  const controller::Timing timing = MakeGloveTiming(config.rate_hz);
  Motion motion = controller::WithinSetting("motion", [&] {
    return SynthesiseMotion(config.motion, {.rate_hz = timing.tick_rate_hz,
                                            .seed = seed,
                                            .start_rad = {},
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

Signal AnswersInCounts(const GloveConfig& config, const GloveSignal& glove, const std::string& file,
                       const std::string& map) {
  const auto* motion = std::get_if<RecordedMotionConfig>(&config.motion.settings);
  if (motion == nullptr || !glove.is_recorded || !glove.recording) {
    throw controller::SettingError(
        "answers",
        "are of a recording, which must be played: glove.motion of kind recording, use: measured");
  }
  if (!IsWithoutNoise(config)) {
    throw controller::SettingError(
        "answers", "are of the recording as it is: glove.noise must be none, without glove.faults");
  }
  const MotionContext context{
      .rate_hz = glove.tick_rate_hz, .seed = 0, .start_rad = {}, .converter = config.converter};
  const Motion answers = MeasuredAgain(*motion, file, map, *glove.recording, context);
  const std::vector<int> indices = ChannelsOf(config);
  for (const int c : indices) {
    if (answers.recording->has_channel[c] || !glove.recording->has_channel[c]) continue;
    throw controller::SettingError(
        "answers",
        fmt::format("{} has no {}, which {} has", file,
                    KnownChannels()[static_cast<std::size_t>(c)].name, glove.recording->name));
  }
  const Signal counts =
      Sampled(Sense(config, answers, {}, glove.tick_rate_hz, 0), glove.ticks_per_sample);
  return counts(Eigen::all, indices);
}

void CutGlove(Eigen::Index ticks, GloveSignal& glove) {
  glove.true_angle_rad.KeepRows(ticks);
  glove.counts.KeepRows((ticks + glove.ticks_per_sample - 1) / glove.ticks_per_sample);
  if (glove.tremor_rad.rows() > 0) glove.tremor_rad.KeepRows(ticks);
  const auto cut = [](auto& parts, Eigen::Index end) {
    std::erase_if(parts, [&](const auto& part) { return part.begin >= end; });
    for (auto& part : parts) part.end = std::min(part.end, static_cast<int>(end));
  };
  cut(glove.segments, ticks);
  cut(glove.masked, ticks);
  cut(glove.faults, glove.counts.rows());
}

GloveConfig WithoutNoise(GloveConfig config) {
  config.noise = {};
  config.noise.kind = WhiteNoiseKind::kNone;
  config.faults.clear();
  return config;
}

bool IsWithoutNoise(const GloveConfig& config) {
  return config.faults.empty() &&
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
  std::vector<double> most, least;
  for (const int c : ChannelsOf(config)) {
    const Channel& channel = KnownChannels()[static_cast<std::size_t>(c)];
    calibration.channel_names.emplace_back(channel.name);
    calibration.low_angle_rad.push_back(channel.min_deg * kRadPerDeg);
    calibration.high_angle_rad.push_back(channel.max_deg * kRadPerDeg);
    const controller::ConverterRange range = config.converter.range(static_cast<std::size_t>(c));
    const NominalCounts nominal = NominalCountsOf(range);
    calibration.low_counts.push_back(nominal.low_counts);
    calibration.high_counts.push_back(nominal.high_counts);
    most.push_back(range.full_scale_counts);
    least.push_back(range.min_counts);
  }
  calibration.full_scale_counts = Shortened(most);
  calibration.min_counts = Shortened(least);
  for (const OwnCalibration& own : config.calibration) {
    const auto place = std::ranges::find(calibration.channel_names, own.channel);
    if (place == calibration.channel_names.end()) continue;
    const auto i = place - calibration.channel_names.begin();
    calibration.low_counts[i] = own.low_counts;
    calibration.high_counts[i] = own.high_counts;
    calibration.low_angle_rad[i] = own.low_deg * kRadPerDeg;
    calibration.high_angle_rad[i] = own.high_deg * kRadPerDeg;
  }
  return calibration;
}

}  // namespace gauntlet::sim
