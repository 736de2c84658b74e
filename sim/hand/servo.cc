#include "sim/hand/servo.h"

#include <algorithm>
#include <cmath>

#include "controller/assert.h"

namespace gauntlet::sim {

ServoTorque ComputeServoTorque(const Servo& servo, double target_rad, double angle_rad,
                               double speed_rad_s) noexcept {
  GAUNTLET_ASSERT(servo.stall_torque_nm > 0.0 && servo.no_load_speed_rad_s > 0.0);
  const double error = target_rad - angle_rad;
  const double beyond = std::copysign(std::max(0.0, std::abs(error) - servo.dead_band_rad), error);
  const double wanted = servo.gain_nm_rad * beyond - servo.damping_nm_s_rad * speed_rad_s;

  const double back_emf = servo.stall_torque_nm * speed_rad_s / servo.no_load_speed_rad_s;
  const double stall = servo.stall_torque_nm;
  const double most = std::clamp(stall - back_emf, -stall, stall);
  const double least = std::clamp(-stall - back_emf, -stall, stall);
  const double torque = std::clamp(wanted, least, most);
  return {torque, torque != wanted};
}

}  // namespace gauntlet::sim
