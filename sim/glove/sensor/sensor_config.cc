#include "sim/glove/sensor/sensor_config.h"

#include <string_view>

namespace gauntlet::sim {

bool SensorConfig::is_drawn() const {
  return gain_deviation_percent > 0.0 || offset_deviation_percent > 0.0 ||
         curvature_deviation_percent > 0.0 || drift_deviation_percent > 0.0 ||
         cross_talk_percent > 0.0 || hysteresis_deg > 0.0 || lag_ms > 0.0;
}

void SensorConfig::Visit(controller::SettingsVisitor& visitor) {
  const auto number = [&visitor](std::string_view key, std::string_view help, double min,
                                 double max, double& value) {
    visitor.Number({.key = key, .help = help, .min = min, .max = max}, value);
  };
  number("gain_deviation_percent", "standard deviation of the gain from glove to glove", 0, 50,
         gain_deviation_percent);
  number("offset_deviation_percent",
         "standard deviation of the offset from glove to glove, of the full scale", 0, 50,
         offset_deviation_percent);
  number("curvature_deviation_percent",
         "standard deviation of the bow in the middle of the range, of the output's range", 0, 30,
         curvature_deviation_percent);
  number("cross_talk_percent", "how much of a neighbour's bending is measured too, about", 0, 50,
         cross_talk_percent);
  number("hysteresis_deg", "play between bending and unbending, median", 0, 45, hysteresis_deg);
  number("lag_ms", "time constant of the sensor, first order, median", 0, 1000, lag_ms);
  number("drift_deviation_percent",
         "standard deviation of the offset that warming adds, of the full scale", 0, 50,
         drift_deviation_percent);
  number("drift_time_s", "time constant of the warming", 1, 100000, drift_time_s);
}

}  // namespace gauntlet::sim
