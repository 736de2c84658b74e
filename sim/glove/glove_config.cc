#include "sim/glove/glove_config.h"

namespace gauntlet::sim {

void GloveConfig::Visit(controller::SettingsVisitor& visitor) {
  visitor.Number({.key = "rate_hz", .help = "samples per second", .min = 50, .max = 10000},
                 rate_hz);
  controller::VisitGroup(visitor, {.key = "motion", .help = "what the wearer does"}, motion);
  controller::VisitGroup(visitor, {.key = "sensor", .help = "the bend sensors"}, sensor);
  controller::VisitGroup(visitor, {.key = "noise", .help = "noise of the electrical signal"},
                         noise);
  controller::VisitGroup(visitor, {.key = "converter", .help = "the analog-digital converter"},
                         converter);
}

}  // namespace gauntlet::sim
