#include "sim/glove/glove_config.h"

namespace gauntlet::sim {

void GloveConfig::Visit(controller::SettingsVisitor& visitor) {
  using controller::VisitGroup;
  visitor.Number({.key = "rate_hz", .help = "samples per second", .min = 10, .max = 10000},
                 rate_hz);
  visitor.Texts(
      {.key = "channels",
       .help = "channels that the glove has, in the order in which it sends them; empty: the first "
               "18 of gauntlet list channels, without the end joints of the fingers"},
      channels);
  VisitGroup(visitor, {.key = "motion", .help = "what the wearer does"}, motion);
  VisitGroup(visitor, {.key = "tremor", .help = "trembling of the wearer's hand"}, tremor);
  VisitGroup(visitor, {.key = "sensor", .help = "the bend sensors"}, sensor);
  VisitGroup(visitor, {.key = "noise", .help = "noise of the electrical signal"}, noise);
  VisitGroup(visitor, {.key = "converter", .help = "the analog-digital converter"}, converter);
  controller::VisitList(visitor, {.key = "faults", .help = "what goes wrong with the glove"},
                        faults);
}

}  // namespace gauntlet::sim
