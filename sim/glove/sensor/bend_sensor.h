#pragma once

#include <cstdint>
#include <vector>

#include "sim/base/signal.h"
#include "sim/glove/sensor/sensor_config.h"

namespace gauntlet::sim {

/// One glove: what a seed drew, per channel.
struct SensorParameters {
  std::vector<double> gain;          // 1 in the nominal sensor
  std::vector<double> offset_share;  // of the full scale; 0 in the nominal sensor
};

SensorParameters NominalSensor();
SensorParameters DrawSensor(const SensorConfig& config, std::uint64_t seed);

/// Analog output of all sensors [counts of a converter with this full scale, not rounded].
/// Shapes: samples x channels.
Signal SenseBend(const SensorConfig& config, const SensorParameters& sensor,
                 const Signal& angle_rad, double full_scale_counts);

}  // namespace gauntlet::sim
