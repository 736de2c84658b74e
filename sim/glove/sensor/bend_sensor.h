#pragma once

#include <cstdint>
#include <vector>

#include "sim/base/signal.h"
#include "sim/glove/sensor/sensor_config.h"

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

/// Analog output of all sensors [counts of a converter with this full scale, not rounded].
/// Shapes: samples x channels.
Signal SenseBend(const SensorConfig& config, const SensorParameters& sensor,
                 const Signal& angle_rad, double rate_hz, double full_scale_counts);

/// The straight line alone: what the nominal sensor gives.
Signal SenseBendNominal(const SensorConfig& config, const Signal& angle_rad,
                        double full_scale_counts);

}  // namespace gauntlet::sim
