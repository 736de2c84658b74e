#include "sim/glove/glove_config.h"

namespace gauntlet::sim {

void GloveConfig::Visit(controller::SettingsVisitor& visitor) {
  using controller::VisitGroup;
  visitor.Number({"rate_hz", "samples per second", 10, 10000}, rate_hz);
  visitor.Texts({"channels",
                 "channels that the glove has, in the order in which it sends them; empty: the "
                 "first 18 of gauntlet list channels, without the end joints of the fingers"},
                channels);
  VisitGroup(visitor, {"motion", "what the wearer does"}, motion);
  VisitGroup(visitor, {"tremor", "tremor of the wearer's hand"}, tremor);
  VisitGroup(visitor, {"sensor", "the bend sensors"}, sensor);
  VisitGroup(visitor, {"noise", "noise of the electrical signal"}, noise);
  VisitGroup(visitor, {"converter", "the analog-digital converter"}, converter);
  controller::VisitList(visitor, {"faults", "what goes wrong with the glove"}, faults);
}

}  // namespace gauntlet::sim
