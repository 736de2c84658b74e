#include "sim/hand/stability.h"

#include <fmt/core.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>

#include "sim/base/error.h"

namespace gauntlet::sim {
namespace {

/// A spring and a damper; those of a cable count as often as its end is stiffer than the whole.
struct Oscillator {
  double stiffness = 0.0;
  double damping = 0.0;

  void Add(const Cord& cord, double arm2_m2) {
    stiffness += cord.EndFactor() * cord.stiffness_n_m * arm2_m2;
    damping += cord.EndFactor() * cord.damping_n_s_m * arm2_m2;
  }
  void Add(const Shaft& shaft, double ratio2) {
    stiffness += shaft.stiffness_nm_rad * ratio2;
    damping += shaft.damping_nm_s_rad * ratio2;
  }
  /// 2 c h + k h^2, of which the inertia must be more than a quarter.
  double Inertia(double step_s) const { return (2.0 * damping + stiffness * step_s) * step_s; }
};

}  // namespace

void GiveLightJointsInertia(mjModel& model, const std::vector<Drive>& drives) {
  std::vector<Oscillator> joints(model.nv);
  for (const Drive& drive : drives) {
    for (const Cable& cable : drive.cables) {
      double arms_m = 0.0;
      for (const Crossing& crossing : cable.crossings) arms_m += std::abs(crossing.moment_arm_m);
      for (const Crossing& crossing : cable.crossings) {
        joints[crossing.dof].Add(cable.cord, std::abs(crossing.moment_arm_m) * arms_m);
      }
    }
    double ratios = 0.0;
    for (const ShaftJoint& joint : drive.shaft.joints) ratios += std::abs(joint.ratio);
    for (const ShaftJoint& joint : drive.shaft.joints) {
      joints[joint.dof].Add(drive.shaft, std::abs(joint.ratio) * ratios);
    }
  }
  for (int dof = 0; dof < model.nv; ++dof) {
    const double least = joints[dof].Inertia(model.opt.timestep);
    const double inertia = 1.0 / model.dof_invweight0[dof];
    if (inertia < least) AddArmature(model, dof, least - inertia);
  }
}

void AddArmature(mjModel& model, int dof, double inertia_kg_m2) {
  model.dof_armature[dof] += inertia_kg_m2;
  // Of a body that turns about its center, the engine takes the inertia from here.
  if (model.dof_simplenum[dof] > 0) model.dof_M0[dof] += inertia_kg_m2;
}

void CheckStability(const mjModel& model, const std::vector<Drive>& drives) {
  const double step_s = model.opt.timestep;
  for (const Drive& drive : drives) {
    const Servo& servo = drive.servo;
    Oscillator spool{
        servo.gain_nm_rad,
        std::max(servo.damping_nm_s_rad, servo.stall_torque_nm / servo.no_load_speed_rad_s)};
    const double of_servo = spool.Inertia(step_s);
    for (const Cable& cable : drive.cables) {
      spool.Add(cable.cord, drive.drum_radius_m * drive.drum_radius_m);
    }
    if (drive.has_shaft()) spool.Add(drive.shaft, 1.0);
    const double of_both = spool.Inertia(step_s);
    if (of_both < 4.0 * drive.spool.inertia_kg_m2) continue;
    if (of_servo < 0.5 * of_both && drive.has_shaft()) {
      throw UserError(
          fmt::format("hand.motor.windup_deg: the gear of {} is too stiff for hand.step_ms {}",
                      drive.name, 1e3 * step_s));
    }
    if (of_servo < 0.5 * of_both) {
      throw UserError(
          fmt::format("hand.cable.stiffness_scale: the cables on the spool of {} are too stiff for "
                      "hand.step_ms {}",
                      drive.name, 1e3 * step_s));
    }
    throw UserError(
        fmt::format("{}: the servo of {} is too stiff for hand.step_ms {}: lower torque_scale or "
                    "damping_ms, or raise full_torque_error_deg or no_load_speed_deg_s",
                    drive.servo_key, drive.name, 1e3 * step_s));
  }
}

}  // namespace gauntlet::sim
