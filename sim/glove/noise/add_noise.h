#pragma once

#include <cstdint>

#include "sim/base/signal.h"
#include "sim/glove/noise/noise_config.h"
#include "sim/glove/sensor/converter.h"

namespace gauntlet::sim {

/// Adds all noise of the configuration to the analog signal [counts of the converter].
void AddNoise(const NoiseConfig& config, const ConverterConfig& converter, double rate_hz,
              std::uint64_t seed, Signal& counts);

/// Variance of what AddNoise() adds to a channel of KnownChannels()
/// [counts^2 of the converter].
double VarianceOfNoise(const NoiseConfig& config, const ConverterConfig& converter, int channel);

}  // namespace gauntlet::sim
