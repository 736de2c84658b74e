#include "sim/hand/hand_config.h"

#include <array>
#include <string_view>

namespace gauntlet::sim {

using controller::SettingsVisitor;

void CableConfig::Visit(SettingsVisitor& visitor) {
  visitor.Flag({.key = "stretch", .help = "cables stretch; off: 8 times as stiff"}, stretch);
  visitor.Number({.key = "stiffness_scale",
                  .help = "factor on the stiffness of the model's cables",
                  .min = 1e-6,
                  .max = 10},
                 stiffness_scale);
  visitor.Number({.key = "pretension_mm",
                  .help = "stretch of both cables of a motor at rest, with the model's stiffness: "
                          "the force stays when stiffness_scale or stretch changes it",
                  .min = 0,
                  .max = 5},
                 pretension_mm);
  visitor.Number({.key = "slack_mm", .help = "excess length of every cable", .min = 0, .max = 20},
                 slack_mm);
  visitor.Number({.key = "capstan_friction",
                  .help = "coefficient of friction where cables bend; 0: none",
                  .min = 0,
                  .max = 0.5},
                 capstan_friction);
  visitor.Number({.key = "backlash_deg",
                  .help = "play of the drum on the motor's shaft, end to end",
                  .min = 0,
                  .max = 30},
                 backlash_deg);
  visitor.Flag({.key = "interference",
                .help = "cables that cross a joint on their way move it and are moved by it"},
               interference);
}

void ObjectConfig::Visit(SettingsVisitor& visitor) {
  visitor.Number({.key = "mass_kg", .help = "mass of the cylinder to grasp", .min = 0.01, .max = 5},
                 mass_kg);
  visitor.Number({.key = "diameter_mm", .help = "its diameter", .min = 20, .max = 60}, diameter_mm);
  visitor.Number({.key = "friction",
                  .help = "coefficient of friction between it and the hand",
                  .min = 0.05,
                  .max = 2},
                 friction);
}

void HandConfig::Visit(SettingsVisitor& visitor) {
  visitor.Path({.key = "model_path", .help = "MJCF file; empty: the project's hand_arm.xml"},
               model_path);
  visitor.Number({.key = "step_ms",
                  .help = "longest time step of the physics; whole steps of at most this long make "
                          "up 1 ms (the period of a glove faster than 1 kHz)",
                  .min = 0.01,
                  .max = 1},
                 step_ms);
  controller::VisitGroup(visitor, {.key = "servo", .help = "the position servos on the spools"},
                         servo);
  controller::VisitGroup(visitor, {.key = "cable", .help = "the cables between spools and joints"},
                         cable);
  controller::VisitGroup(
      visitor, {.key = "joint_sensors", .help = "what measures the hand's joints"}, joint_sensors);
  static constexpr std::array<std::string_view, 3> kContacts = {"none", "hand", "object"};
  controller::VisitEnum(
      visitor,
      {.key = "contact", .help = "what touches: nothing, the hand itself, or also an object"},
      kContacts, contact);
  controller::VisitGroup(
      visitor, {.key = "object", .help = "the cylinder to grasp, if there is one"}, object);
}

}  // namespace gauntlet::sim
