#include "sim/glove/glove_config.h"

namespace gauntlet::sim {

void OwnCalibration::Visit(controller::SettingsVisitor& visitor) {
  visitor.Text({.key = "channel", .help = "its name", .required = true}, channel);
  visitor.Number({.key = "low_counts", .help = "in the first pose", .required = true}, low_counts);
  visitor.Number({.key = "high_counts", .help = "in the second", .required = true}, high_counts);
  visitor.Number({.key = "low_deg", .help = "angle in the first pose", .required = true}, low_deg);
  visitor.Number({.key = "high_deg", .help = "angle in the second", .required = true}, high_deg);
  visitor.Text({"assumed", "guesses about it: joint, unit, sign, range, rate"}, assumed);
}

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
  controller::VisitList(visitor,
                        {"calibration",
                         "two known poses of channels whose recorded counts reach the controller "
                         "(use: measured); by default those of the column map"},
                        calibration);
  controller::VisitList(visitor, {"faults", "what goes wrong with the glove"}, faults);
}

}  // namespace gauntlet::sim
