#include "sim/glove/sensor/bend_sensor.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>
#include <utility>

#include "controller/assert.h"
#include "sim/base/channels.h"
#include "sim/base/normal_pair.h"
#include "sim/base/random.h"
#include "sim/base/stop.h"

namespace gauntlet::sim {
namespace {

/// Standard deviation of the logarithms of hysteresis and lag.
constexpr double kSlownessDeviationPercent = 20.0;

/// Output of the nominal sensor at the ends of a joint's range, of the full scale.
constexpr double kLowPercent = 10.0;
constexpr double kHighPercent = 90.0;

/// Sensors that lie beside or in line with each other.
constexpr std::array<std::pair<std::string_view, std::string_view>, 13> kNeighbours = {
    {{"thumb_rotation", "thumb_abduction"},
     {"thumb_abduction", "thumb_mcp"},
     {"thumb_mcp", "thumb_ip"},
     {"index_mcp", "index_pip"},
     {"middle_mcp", "middle_pip"},
     {"ring_mcp", "ring_pip"},
     {"little_mcp", "little_pip"},
     {"index_mcp", "middle_mcp"},
     {"middle_mcp", "ring_mcp"},
     {"ring_mcp", "little_mcp"},
     {"index_mcp", "finger_spread"},
     {"wrist_flexion", "wrist_deviation"},
     {"elbow_flexion", "shoulder_flexion"}}};

/// Bending of one channel, 0 .. 1 over the joint's range.
void Bend(const Signal& angle_rad, Eigen::Index c, Signal& bend) {
  const Channel& joint = KnownChannels()[static_cast<std::size_t>(c)];
  const double min_rad = joint.min_deg * kRadPerDeg;
  const double per_rad = 1.0 / ((joint.max_deg - joint.min_deg) * kRadPerDeg);
  bend.col(c) = (angle_rad.col(c).array() - min_rad) * per_rad;
}

/// y' = (x - y) / lag, exact for a step input; starts settled.
void Lag(double lag_s, double rate_hz, Eigen::Ref<Eigen::VectorXd> bend) {
  const double share = -std::expm1(-1.0 / (lag_s * rate_hz));
  double y = bend[0];
  for (double& x : bend) {
    y += share * (x - y);
    x = y;
  }
}

/// Play: the output stands still until the input has moved through half the play on either side.
void Hysteresis(double play, Eigen::Ref<Eigen::VectorXd> bend) {
  const double half = 0.5 * play;
  double y = bend[0];
  for (double& x : bend) {
    y = std::max(x - half, std::min(x + half, y));
    x = y;
  }
}

void AddCrossTalk(const std::vector<CrossTalk>& cross_talk, Signal& bend) {
  if (cross_talk.empty()) return;
  // Block by block, each channel's own bending kept before the neighbours are added.
  constexpr Eigen::Index kBlock = 512;
  Signal own(kBlock, bend.cols());
  for (Eigen::Index begin = 0; begin < bend.rows(); begin += kBlock) {
    const Eigen::Index rows = std::min(kBlock, bend.rows() - begin);
    own.topRows(rows) = bend.middleRows(begin, rows);
    TrimSignals();
    for (const CrossTalk& pair : cross_talk) {
      bend.col(pair.to).segment(begin, rows).array() +=
          pair.share * (own.col(pair.from).head(rows).array() - 0.5);
    }
  }
}

}  // namespace

SensorParameters NominalSensor() {
  const std::size_t channels = KnownChannels().size();
  const std::vector<double> zeros(channels, 0.0);
  const std::vector<double> ones(channels, 1.0);
  return {.gain = ones,
          .offset_share = zeros,
          .curvature_share = zeros,
          .drift_share = zeros,
          .hysteresis_scale = ones,
          .lag_scale = ones,
          .cross_talk = {}};
}

SensorParameters DrawSensor(const SensorConfig& config, std::uint64_t seed) {
  SensorParameters sensor = NominalSensor();
  for (std::size_t channel = 0; channel < sensor.gain.size(); ++channel) {
    RandomStream random(seed, "sensor/deviation", channel);
    const NormalPair line = BoxMuller(random);
    const NormalPair rest = BoxMuller(random);
    const NormalPair late = BoxMuller(random);
    sensor.gain[channel] += 0.01 * config.gain_deviation_percent * line.first;
    sensor.offset_share[channel] = 0.01 * config.offset_deviation_percent * line.second;
    sensor.curvature_share[channel] = 0.01 * config.curvature_deviation_percent * rest.first;
    sensor.drift_share[channel] = 0.01 * config.drift_deviation_percent * rest.second;
    sensor.hysteresis_scale[channel] = std::exp(0.01 * kSlownessDeviationPercent * late.first);
    sensor.lag_scale[channel] = std::exp(0.01 * kSlownessDeviationPercent * late.second);
  }
  if (config.cross_talk_percent == 0.0) return sensor;
  for (std::size_t pair = 0; pair < kNeighbours.size(); ++pair) {
    const int a = ChannelIndex(kNeighbours[pair].first);
    const int b = ChannelIndex(kNeighbours[pair].second);
    RandomStream random(seed, "sensor/cross_talk", pair);
    const NormalPair draws = BoxMuller(random);
    // Half of the mean as deviation: sensors are sewn on by hand.
    sensor.cross_talk.push_back({a, b, 0.01 * config.cross_talk_percent * (1 + 0.5 * draws.first)});
    sensor.cross_talk.push_back(
        {b, a, 0.01 * config.cross_talk_percent * (1 + 0.5 * draws.second)});
  }
  return sensor;
}

Signal SenseBend(const SensorConfig& config, const SensorParameters& sensor,
                 const Signal& angle_rad, double rate_hz,
                 std::span<const controller::ConverterRange> converters) {
  GAUNTLET_ASSERT(rate_hz > 0.0 && angle_rad.cols() <= std::ssize(sensor.gain) &&
                  angle_rad.cols() <= std::ssize(converters));
  GAUNTLET_ASSERT(sensor.drift_share.size() == sensor.gain.size() &&
                  sensor.offset_share.size() == sensor.gain.size());
  Signal bend(angle_rad.rows(), angle_rad.cols());
  for (Eigen::Index c = 0; c < bend.cols(); ++c) {
    ThrowIfStopped();
    const auto channel = static_cast<std::size_t>(c);
    Bend(angle_rad, c, bend);
    const double lag_s = 1e-3 * config.lag_ms * sensor.lag_scale[channel];
    if (lag_s > 0.0) Lag(lag_s, rate_hz, bend.col(c));
    const double play_deg = config.hysteresis_deg * sensor.hysteresis_scale[channel];
    const Channel& joint = KnownChannels()[channel];
    if (play_deg > 0.0) Hysteresis(play_deg / (joint.max_deg - joint.min_deg), bend.col(c));
    TrimSignals();
  }
  AddCrossTalk(sensor.cross_talk, bend);
  for (Eigen::Index c = 0; c < bend.cols(); ++c) {
    const auto channel = static_cast<std::size_t>(c);
    const double scale = converters[channel].span_counts();
    const double low = NominalCountsOf(converters[channel]).low_counts;
    const double span = 0.01 * (kHighPercent - kLowPercent) * scale;
    const double gain = sensor.gain[channel];
    const double bow = 4.0 * sensor.curvature_share[channel];
    const double start = low + span * (0.5 - 0.5 * gain) + sensor.offset_share[channel] * scale;
    const auto b = bend.col(c).array();
    bend.col(c) = start + span * (b * (gain + bow * (1.0 - b)));
    TrimSignals();
    if (sensor.drift_share[channel] == 0.0) continue;
    const double drift = sensor.drift_share[channel] * scale;
    for (Eigen::Index i = 0; i < bend.rows(); ++i) {
      bend(i, c) -= drift * std::expm1(-static_cast<double>(i) / rate_hz / config.drift_time_s);
    }
  }
  return bend;
}

Signal SenseBendNominal(const Signal& angle_rad,
                        std::span<const controller::ConverterRange> converters) {
  SensorConfig nominal;
  nominal.hysteresis_deg = 0.0;
  nominal.lag_ms = 0.0;
  return SenseBend(nominal, NominalSensor(), angle_rad, 1000.0, converters);
}

NominalCounts NominalCountsOf(const controller::ConverterRange& range) {
  return {.min_counts = range.min_counts,
          .low_counts = range.min_counts + 0.01 * kLowPercent * range.span_counts(),
          .high_counts = range.min_counts + 0.01 * kHighPercent * range.span_counts()};
}

std::vector<NominalCounts> NominalCountsOf(const ConverterConfig& converter) {
  std::vector<NominalCounts> nominal;
  for (const controller::ConverterRange& range : converter.ranges()) {
    nominal.push_back(NominalCountsOf(range));
  }
  return nominal;
}

}  // namespace gauntlet::sim
