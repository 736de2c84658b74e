#include "sim/hand/hand_config.h"

#include <array>
#include <string_view>

namespace gauntlet::sim {

using controller::SettingsVisitor;

void CableConfig::Visit(SettingsVisitor& visitor) {
  visitor.Number({"stiffness_scale", "factor on the stiffness of the model's cables", 1e-6, 10},
                 stiffness_scale);
  visitor.Number(
      {"stiffness_n_m", "stiffness of the cables whose tendon has none in the model; 0: not known",
       0, 1e7},
      stiffness_n_m);
  visitor.Number({"pretension_mm",
                  "stretch of both cables of a motor at rest, with the model's stiffness: the "
                  "force stays when stiffness_scale changes it",
                  0, 5},
                 pretension_mm);
  visitor.Numbers(
      {"slack_mm", "excess length of the cables: one for all motors, or one for each", 0, 20},
      slack_mm);
  visitor.Number({"capstan_friction", "coefficient of friction where cables bend; 0: none", 0, 0.5},
                 capstan_friction);
  visitor.Number(
      {"backlash_deg",
       "backlash of the drum, or of a joint without cables, on the motor's shaft, end to end", 0,
       30},
      backlash_deg);
}

void AssemblyErrorConfig::Visit(SettingsVisitor& visitor) {
  visitor.Integer({"seed", "which hand of those that could be built", 0}, seed);
  // No normal error that the generator gives is as large as 10 standard deviations.
  visitor.Number(
      {"drum_radius_percent",
       "standard deviation of each drum's radius, which the controller does not know", 0, 10},
      drum_radius_percent);
  visitor.Number(
      {"moment_arm_percent",
       "standard deviation of the moment arm of each motor's cables at each joint", 0, 10},
      moment_arm_percent);
  visitor.Number({"centre_deg",
                  "standard deviation of where each joint stands when the controller takes it to "
                  "be in the middle of its range",
                  0, 10},
                 centre_deg);
}

void MotorConfig::Visit(SettingsVisitor& visitor) {
  visitor.Numbers(
      {"stall_torque_nm",
       "stall torque at the spool or joint: one for all motors, or one for each; empty: "
       "as the model has it",
       1e-6, 1000},
      stall_torque_nm);
  visitor.Numbers(
      {"rotor_inertia_kg_m2",
       "inertia of the rotor behind its gear, likewise; empty: armature of the spool or "
       "joint",
       1e-9, 10},
      rotor_inertia_kg_m2);
  visitor.Numbers(
      {"dry_friction_nm",
       "dry friction of the gear, likewise; empty: frictionloss of the spool or joint", 0, 100},
      dry_friction_nm);
  visitor.Numbers(
      {"drum_radius_mm",
       "radius of the drum of a motor that pulls a tendon without a drum, likewise", 0.1, 1000},
      drum_radius_mm);
  visitor.Number(
      {"windup_deg", "angle by which the gear of a motor without cables twists at its stall torque",
       0.05, 20},
      windup_deg);
}

void ObjectConfig::Visit(SettingsVisitor& visitor) {
  visitor.Number({"mass_kg", "mass of the cylinder to grasp", 0.01, 5}, mass_kg);
  visitor.Number({"diameter_mm", "its diameter", 20, 60}, diameter_mm);
  visitor.Number({"friction", "coefficient of friction between it and the hand", 0.05, 2},
                 friction);
}

HandConfig::KeyedServo HandConfig::ServoOf(double stall_torque_nm) const {
  constexpr double kStrongest_nm = 5.0;
  if (stall_torque_nm > kStrongest_nm) return {"hand.arm_servo", arm_servo.numbers()};
  return {"hand.servo", servo.numbers()};
}

void HandConfig::Visit(SettingsVisitor& visitor) {
  visitor.Path({"model_path", "MJCF file; empty: the project's hand_arm.xml"}, model_path);
  visitor.Number({"step_ms",
                  "longest time step of the physics; whole steps of at most this long make up 1 ms "
                  "(the period of a glove faster than 1 kHz)",
                  0.01, 1},
                 step_ms);
  controller::VisitGroup(visitor, {"servo", "the position servos of motors of at most 5 N m"},
                         servo);
  controller::VisitGroup(visitor, {"arm_servo", "those of stronger motors: elbow and shoulder"},
                         arm_servo);
  visitor.Numbers({"motor_friction_scale",
                   "factor on all friction of a motor, that of its spool and of its cables: one "
                   "for all motors, or one for each",
                   0, 100},
                  motor_friction_scale);
  controller::VisitGroup(visitor, {"motor", "numbers of motors that replace those of the model"},
                         motor);
  visitor.Flag({"motor_limits",
                "motors have the torque and the speed of their kind; off: any, with the gain of "
                "torque_scale 1 or more"},
               motor_limits);
  controller::VisitGroup(visitor, {"cable", "the cables between spools and joints"}, cable);
  controller::VisitGroup(
      visitor, {"assembly_error", "how far the built hand is off what the controller knows"},
      assembly_error);
  controller::VisitGroup(visitor, {"joint_sensors", "what measures the hand's joints"},
                         joint_sensors);
  static constexpr std::array<std::string_view, 3> kContacts = {"none", "hand", "object"};
  controller::VisitEnum(
      visitor,
      {"contact",
       "what touches: nothing, the hand itself (palm, thumb and each finger), or also an object"},
      kContacts, contact);
  controller::VisitGroup(visitor, {"object", "the cylinder to grasp, if there is one"}, object);
}

}  // namespace gauntlet::sim
