#include "sim/glove/sensor/bend_sensor.h"

#include "sim/base/random.h"
#include "sim/glove/channels.h"
#include "sim/glove/noise/box_muller.h"

namespace gauntlet::sim {

SensorParameters NominalSensor() {
  const std::size_t channels = GloveChannels().size();
  return {std::vector<double>(channels, 1.0), std::vector<double>(channels, 0.0)};
}

SensorParameters DrawSensor(const SensorConfig& config, std::uint64_t seed) {
  SensorParameters sensor = NominalSensor();
  for (std::size_t channel = 0; channel < sensor.gain.size(); ++channel) {
    RandomStream random(seed, "sensor/deviation", channel);
    const NormalPair pair = BoxMuller(random);
    sensor.gain[channel] += 0.01 * config.gain_deviation_percent * pair.first;
    sensor.offset_share[channel] += 0.01 * config.offset_deviation_percent * pair.second;
  }
  return sensor;
}

Signal SenseBend(const SensorConfig& config, const SensorParameters& sensor,
                 const Signal& angle_rad, double full_scale_counts) {
  const auto channels = GloveChannels();
  const double middle = 0.005 * (config.low_percent + config.high_percent);
  const double span = 0.01 * (config.high_percent - config.low_percent);
  Signal counts(angle_rad.rows(), angle_rad.cols());
  for (std::size_t channel = 0; channel < channels.size(); ++channel) {
    const double range_rad = (channels[channel].max_deg - channels[channel].min_deg) * kRadPerDeg;
    const double center_rad =
        0.5 * (channels[channel].max_deg + channels[channel].min_deg) * kRadPerDeg;
    const double counts_per_rad = sensor.gain[channel] * span / range_rad * full_scale_counts;
    const double center_counts = (middle + sensor.offset_share[channel]) * full_scale_counts;
    const auto column = static_cast<Eigen::Index>(channel);
    counts.col(column) =
        center_counts + counts_per_rad * (angle_rad.col(column).array() - center_rad);
  }
  return counts;
}

}  // namespace gauntlet::sim
