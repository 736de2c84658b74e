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

void AssemblyErrorConfig::Visit(SettingsVisitor& visitor) {
  visitor.Integer({.key = "seed", .help = "which hand of those that could be built", .min = 0},
                  seed);
  // No normal error that the generator gives is as large as 10 standard deviations.
  visitor.Number({.key = "drum_radius_percent",
                  .help = "standard deviation of each drum's radius, which the controller does not "
                          "know",
                  .min = 0,
                  .max = 10},
                 drum_radius_percent);
  visitor.Number(
      {.key = "moment_arm_percent",
       .help = "standard deviation of the moment arm of each motor's cables at each joint",
       .min = 0,
       .max = 10},
      moment_arm_percent);
  visitor.Number({.key = "centre_deg",
                  .help = "standard deviation of where each joint stands when the controller takes "
                          "it to be in the middle of its range",
                  .min = 0,
                  .max = 10},
                 centre_deg);
}

void SnapConfig::Visit(SettingsVisitor& visitor) {
  visitor.Text({.key = "cable", .help = "name of the cable that snaps; empty: none"}, cable);
  visitor.Number({.key = "at_s",
                  .help = "simulated time from which on it pulls no more",
                  .min = 0,
                  .max = 3600},
                 at_s);
}

void WearConfig::Visit(SettingsVisitor& visitor) {
  visitor.Number({.key = "slack_mm_per_hour",
                  .help = "every cable becomes longer by this in an hour of simulated time; first "
                          "it loses its pretension",
                  .min = 0,
                  .max = 36000},
                 slack_mm_per_hour);
  visitor.Number({.key = "slack_mm_per_km",
                  .help = "and by this for each km that its drum winds, to and fro",
                  .min = 0,
                  .max = 100000},
                 slack_mm_per_km);
  controller::VisitGroup(visitor, {.key = "snap", .help = "a cable that snaps"}, snap);
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

HandConfig::KeyedServo HandConfig::ServoOf(double stall_torque_nm) const {
  constexpr double kStrongest_nm = 5.0;
  if (stall_torque_nm > kStrongest_nm) return {"hand.arm_servo", arm_servo.numbers()};
  return {"hand.servo", servo.numbers()};
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
  controller::VisitGroup(
      visitor, {.key = "servo", .help = "the position servos of motors of at most 5 N m"}, servo);
  controller::VisitGroup(
      visitor, {.key = "arm_servo", .help = "those of stronger motors: elbow and shoulder"},
      arm_servo);
  visitor.Numbers(
      {.key = "motor_friction_scale",
       .help = "factor on all friction of a motor, that of its spool and of its cables: "
               "one for all motors, or one for each",
       .min = 0,
       .max = 100},
      motor_friction_scale);
  controller::VisitGroup(visitor, {.key = "cable", .help = "the cables between spools and joints"},
                         cable);
  controller::VisitGroup(
      visitor,
      {.key = "assembly_error", .help = "how far the built hand is off what the controller knows"},
      assembly_error);
  controller::VisitGroup(
      visitor, {.key = "wear", .help = "what time and use do to cables that are new at first"},
      wear);
  controller::VisitGroup(
      visitor, {.key = "joint_sensors", .help = "what measures the hand's joints"}, joint_sensors);
  static constexpr std::array<std::string_view, 3> kContacts = {"none", "hand", "object"};
  controller::VisitEnum(
      visitor,
      {.key = "contact",
       .help = "what touches: nothing, the hand itself (palm, thumb and each finger), or also an "
               "object"},
      kContacts, contact);
  controller::VisitGroup(
      visitor, {.key = "object", .help = "the cylinder to grasp, if there is one"}, object);
}

}  // namespace gauntlet::sim
