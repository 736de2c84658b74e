#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "sim/base/signal.h"
#include "sim/glove/noise/noise_config.h"
#include "sim/glove/sensor/converter.h"
#include "sim/glove/sensor/sensor_config.h"

namespace gauntlet::sim {

/// Adds all noise of the configuration to the analog signal [counts of the converter].
/// `remarks` hears what was repaired in a recording.
/// Errors: UserError for a recording that cannot be read.
void AddNoise(const NoiseConfig& config, const SensorConfig& sensor,
              const ConverterConfig& converter, double rate_hz, std::uint64_t seed, Signal& counts,
              std::vector<std::string>& remarks);

/// Variance of what AddNoise() adds to a channel of KnownChannels(), random walk and recordings
/// left out [counts^2 of the converter].
double VarianceOfNoise(const NoiseConfig& config, const ConverterConfig& converter, int channel);

}  // namespace gauntlet::sim
