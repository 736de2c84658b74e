#include "sim/hand/stability.h"

#include <fmt/core.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <string>

#include "sim/base/error.h"

namespace gauntlet::sim {
namespace {

struct Oscillator {
  double stiffness_nm_rad = 0.0;
  double damping_nm_s_rad = 0.0;

  void Add(const Cord& cord, double arm_m) {
    stiffness_nm_rad += cord.EndFactor() * cord.stiffness_n_m * arm_m * arm_m;
    damping_nm_s_rad += cord.EndFactor() * cord.damping_n_s_m * arm_m * arm_m;
  }
  bool Stable(double inverse_inertia, double step_s) const {
    return (2.0 * damping_nm_s_rad + stiffness_nm_rad * step_s) * step_s * inverse_inertia < 4.0;
  }
};

}  // namespace

void CheckStability(const mjModel& model, const std::vector<Drive>& drives) {
  const double step_s = model.opt.timestep;
  std::vector<Oscillator> joints(model.nv);
  for (const Drive& drive : drives) {
    const Servo& servo = drive.servo;
    Oscillator spool{
        servo.gain_nm_rad,
        std::max(servo.damping_nm_s_rad, servo.stall_torque_nm / servo.no_load_speed_rad_s)};
    for (const Cable& cable : drive.cables) {
      spool.Add(cable.cord, drive.drum_radius_m);
      for (const Crossing& crossing : cable.crossings) {
        joints[crossing.dof].Add(cable.cord, crossing.moment_arm_m);
      }
    }
    if (!spool.Stable(1.0 / drive.spool.inertia_kg_m2, step_s)) {
      throw UserError(fmt::format(
          "hand.servo: the servo of {} is too stiff for hand.step_ms {}: lower torque_scale or "
          "damping_ms, or raise full_torque_error_deg or no_load_speed_deg_s",
          drive.name, 1e3 * step_s));
    }
  }
  for (int dof = 0; dof < model.nv; ++dof) {
    if (joints[dof].Stable(model.dof_invweight0[dof], step_s)) continue;
    const char* name = mj_id2name(&model, mjOBJ_JOINT, model.dof_jntid[dof]);
    throw UserError(fmt::format(
        "hand.cable.stiffness_scale: the cables at joint '{}' are too stiff for hand.step_ms {}",
        name == nullptr ? "?" : name, 1e3 * step_s));
  }
}

}  // namespace gauntlet::sim
