#include "sim/glove/noise/add_noise.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <span>

#include "sim/base/channels.h"
#include "sim/base/random.h"
#include "sim/base/stop.h"
#include "sim/glove/noise/box_muller.h"
#include "sim/glove/noise/coloured_noise.h"
#include "sim/glove/noise/galton_board.h"
#include "sim/glove/sensor/bend_sensor.h"
#include "sim/recordings/recording.h"
#include "sim/recordings/zero_phase.h"

namespace gauntlet::sim {
namespace {

// The full scale in whose counts noise is given, see NoiseConfig.
constexpr double kNoiseFullScaleCounts = 1023.0;

/// Counts of a channel's converter per count in which noise is given.
double NoiseScale(const ConverterConfig& converter, Eigen::Index channel) {
  return converter.range(static_cast<std::size_t>(channel)).span_counts() / kNoiseFullScaleCounts;
}

void AddWhite(const NoiseConfig& config, RandomStream& random, double deviation,
              std::span<double> signal) {
  if (config.kind == WhiteNoiseKind::kBoxMuller) AddBoxMuller(random, deviation, signal);
  if (config.kind == WhiteNoiseKind::kGalton) {
    AddGalton(random, config.galton_rows, config.galton_balls, deviation, signal);
  }
}

/// Correlated white noise: independent normal numbers times the Cholesky factor of the covariance.
void AddCorrelated(const NoiseConfig& config, const ConverterConfig& converter, std::uint64_t seed,
                   Signal& counts) {
  const auto channels = static_cast<Eigen::Index>(config.covariance_channels());
  Eigen::MatrixXd covariance =
      Eigen::Map<const Eigen::MatrixXd>(config.covariance_counts2.data(), channels, channels);
  for (Eigen::Index i = 0; i < channels; ++i) {
    for (Eigen::Index j = 0; j < channels; ++j) {
      covariance(i, j) *=
          config.variance_scale * NoiseScale(converter, i) * NoiseScale(converter, j);
    }
  }
  const Eigen::MatrixXd factor = Eigen::LLT<Eigen::MatrixXd>(covariance).matrixL();
  std::vector<RandomStream> random;
  for (Eigen::Index c = 0; c < channels; ++c) {
    random.emplace_back(seed, "noise/white", static_cast<std::uint64_t>(c));
  }
  // Blocks of an even number of samples stay in the cache and break no Box-Muller pair.
  constexpr Eigen::Index kBlock = 256;
  Eigen::VectorXd white(kBlock);
  for (Eigen::Index begin = 0; begin < counts.rows(); begin += kBlock) {
    const Eigen::Index rows = std::min(kBlock, counts.rows() - begin);
    if (begin % kTrimRows == 0) {
      ThrowIfStopped();
      TrimSignals();
    }
    for (Eigen::Index k = 0; k < channels; ++k) {
      white.setZero();
      AddWhite(config, random[static_cast<std::size_t>(k)], 1.0,
               {white.data(), static_cast<std::size_t>(rows)});
      for (Eigen::Index c = k; c < channels; ++c) {
        counts.col(c).segment(begin, rows) += factor(c, k) * white.head(rows);
      }
    }
  }
}

/// A glove says nothing of what lies above half its rate; near it the smoothing leaves no noise.
constexpr double kHighestSmoothingPerRate = 0.4;

void CheckSmoothing(double smoothing_hz, double rate_hz) {
  const double most_hz = kHighestSmoothingPerRate * rate_hz;
  if (smoothing_hz <= most_hz) return;
  throw controller::SettingError("noise.recording_smoothing_hz",
                                 "is " + controller::NumberText(smoothing_hz) +
                                     ", must be at most " + controller::NumberText(most_hz) +
                                     ", 0.4 times glove.rate_hz: a glove so slow has no noise "
                                     "above it");
}

/// The noise of a recording, played over and over, at the converter's counts.
void AddRecordedNoise(const NoiseConfig& config, const SensorConfig& sensor,
                      const ConverterConfig& converter, double rate_hz, Signal& counts,
                      std::vector<std::string>& remarks) {
  CheckSmoothing(config.recording_smoothing_hz, rate_hz);
  RecordingFormat format;
  format.map = config.recording_map;
  format.rate_hz = config.recording_rate_hz;
  format.rate_key = "recording_rate_hz";
  format.handling = config.recording_problems;
  format.longest_gap_ms = config.recording_longest_gap_ms;
  format.repair_budget_percent = 100.0;  // of noise, any part will do
  format.keeps_to_range = false;         // only its noise is wanted
  format.nominal = NominalCountsOf(sensor, converter);
  // No more of the file than the signal can use, and a little for the smoothing at its end.
  const double duration_s = static_cast<double>(counts.rows()) / rate_hz + 1.0;
  const Recording recording = LoadRecording(config.recording, format, 0.0, duration_s);
  remarks.insert(remarks.end(), recording.remarks.begin(), recording.remarks.end());
  const auto samples =
      static_cast<std::size_t>(std::clamp(recording.time_s.back() * rate_hz + 1.0, 2.0, 1e7));
  for (Eigen::Index c = 0; c < counts.cols(); ++c) {
    if (!recording.has_channel[static_cast<std::size_t>(c)]) continue;
    const Resampled raw =
        Resample(recording, c, 0.0, rate_hz, samples, 1e-3 * config.recording_longest_gap_ms);
    std::vector<double> smooth = raw.value;
    SmoothZeroPhase(config.recording_smoothing_hz, rate_hz, smooth);
    const Channel& joint = KnownChannels()[static_cast<std::size_t>(c)];
    const double counts_per_rad = 0.01 * (sensor.high_percent - sensor.low_percent) *
                                  converter.range(static_cast<std::size_t>(c)).span_counts() /
                                  ((joint.max_deg - joint.min_deg) * kRadPerDeg);
    std::vector<double> noise;
    for (std::size_t i = 0; i < samples; ++i) {
      // Where nothing was recorded there is no noise to take.
      if (!raw.mask[i]) noise.push_back(counts_per_rad * (raw.value[i] - smooth[i]));
    }
    if (noise.empty()) continue;
    for (Eigen::Index i = 0; i < counts.rows(); ++i) {
      counts(i, c) += config.recording_scale * noise[static_cast<std::size_t>(i) % noise.size()];
    }
    TrimSignals();
  }
}

}  // namespace

double VarianceOfNoise(const NoiseConfig& config, const ConverterConfig& converter, int channel) {
  const double scale = NoiseScale(converter, channel);
  const double white = config.kind == WhiteNoiseKind::kNone ? 0.0 : config.VarianceCounts2(channel);
  const double hum = 0.5 * config.mains_amplitude_counts * config.mains_amplitude_counts;
  return scale * scale * (white + config.pink_variance_counts2 + hum);
}

void AddNoise(const NoiseConfig& config, const SensorConfig& sensor,
              const ConverterConfig& converter, double rate_hz, std::uint64_t seed, Signal& counts,
              std::vector<std::string>& remarks) {
  const bool correlated =
      config.kind != WhiteNoiseKind::kNone && !config.covariance_counts2.empty();
  if (correlated) AddCorrelated(config, converter, seed, counts);
  for (Eigen::Index c = 0; c < counts.cols(); ++c) {
    const std::span<double> signal(counts.col(c).data(), static_cast<std::size_t>(counts.rows()));
    const double scale = NoiseScale(converter, c);
    const auto stream = [&](std::string_view purpose) {
      return RandomStream(seed, purpose, static_cast<std::uint64_t>(c));
    };
    const bool has_noise =
        correlated && c < static_cast<Eigen::Index>(config.covariance_channels());
    if (config.kind != WhiteNoiseKind::kNone && !has_noise) {
      RandomStream random = stream("noise/white");
      AddWhite(config, random, scale * std::sqrt(config.VarianceCounts2(static_cast<int>(c))),
               signal);
    }
    if (config.pink_variance_counts2 > 0.0) {
      RandomStream random = stream("noise/pink");
      AddPinkNoise(random, scale * std::sqrt(config.pink_variance_counts2), rate_hz, signal);
    }
    if (config.mains_amplitude_counts > 0.0) {
      RandomStream random = stream("noise/mains");
      AddMainsHum(random, scale * config.mains_amplitude_counts, config.mains_hz, rate_hz, signal);
    }
    if (config.walk_counts_per_sqrt_s > 0.0) {
      RandomStream random = stream("noise/walk");
      AddRandomWalk(random, scale * config.walk_counts_per_sqrt_s, rate_hz, signal);
    }
    TrimSignals();
  }
  if (!config.recording.empty()) {
    AddRecordedNoise(config, sensor, converter, rate_hz, counts, remarks);
  }
}

}  // namespace gauntlet::sim
