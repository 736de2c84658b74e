#include "sim/glove/sensor/sensor_config.h"

namespace gauntlet::sim {

void SensorConfig::Visit(controller::SettingsVisitor& visitor) {
  visitor.Number({.key = "low_percent",
                  .help = "output at the lower end of the joint's range, of the full scale",
                  .min = 0,
                  .max = 45},
                 low_percent);
  visitor.Number({.key = "high_percent",
                  .help = "output at the upper end of the joint's range, of the full scale",
                  .min = 55,
                  .max = 100},
                 high_percent);
  visitor.Number({.key = "gain_deviation_percent",
                  .help = "standard deviation of the gain from glove to glove",
                  .min = 0,
                  .max = 50},
                 gain_deviation_percent);
  visitor.Number({.key = "offset_deviation_percent",
                  .help = "standard deviation of the offset from glove to glove, of the full scale",
                  .min = 0,
                  .max = 50},
                 offset_deviation_percent);
}

}  // namespace gauntlet::sim
