#include "sim/glove/noise/add_noise.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <span>

#include "sim/base/normal_pair.h"
#include "sim/base/random.h"
#include "sim/base/stop.h"
#include "sim/glove/noise/coloured_noise.h"
#include "sim/glove/noise/galton_board.h"

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

}  // namespace

double VarianceOfNoise(const NoiseConfig& config, const ConverterConfig& converter, int channel) {
  const double scale = NoiseScale(converter, channel);
  const double white = config.kind == WhiteNoiseKind::kNone ? 0.0 : config.VarianceCounts2(channel);
  const double hum = 0.5 * config.mains_amplitude_counts * config.mains_amplitude_counts;
  return scale * scale * (white + config.pink_variance_counts2 + hum);
}

void AddNoise(const NoiseConfig& config, const ConverterConfig& converter, double rate_hz,
              std::uint64_t seed, Signal& counts) {
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
    TrimSignals();
  }
}

}  // namespace gauntlet::sim
