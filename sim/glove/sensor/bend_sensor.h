#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "sim/base/signal.h"
#include "sim/glove/sensor/converter.h"
#include "sim/glove/sensor/sensor_config.h"
#include "sim/recordings/column_scale.h"

namespace gauntlet::sim {

/// One sensor sees some of another channel's bending.
struct CrossTalk {
  int from = 0;
  int to = 0;
  double share = 0.0;
};

/// One glove: what a seed drew.
struct SensorParameters {
  std::vector<double> gain;              // per channel; 1 in the nominal sensor
  std::vector<double> offset_share;      // per channel, of the full scale
  std::vector<double> curvature_share;   // per channel, of the output's range
  std::vector<double> drift_share;       // per channel, of the full scale
  std::vector<double> hysteresis_scale;  // per channel, on the setting
  std::vector<double> lag_scale;         // per channel, on the setting
  std::vector<CrossTalk> cross_talk;
};

SensorParameters NominalSensor();
SensorParameters DrawSensor(const SensorConfig& config, std::uint64_t seed);

/// Analog output of all sensors [counts of each channel's converter, not rounded].
/// Shapes: samples x channels.
Signal SenseBend(const SensorConfig& config, const SensorParameters& sensor,
                 const Signal& angle_rad, double rate_hz,
                 std::span<const controller::ConverterRange> converters);

/// The straight line alone: what the nominal sensor gives.
Signal SenseBendNominal(const Signal& angle_rad,
                        std::span<const controller::ConverterRange> converters);

/// The nominal sensor's counts at the ends of a joint's range, by the range of its converter.
NominalCounts NominalCountsOf(const controller::ConverterRange& range);
/// Counts of the nominal sensor, for each channel of KnownChannels().
std::vector<NominalCounts> NominalCountsOf(const ConverterConfig& converter);

}  // namespace gauntlet::sim
