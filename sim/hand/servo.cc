#include "sim/hand/servo.h"

#include <algorithm>
#include <cmath>

#include "controller/assert.h"

namespace gauntlet::sim {
namespace {

/// The largest torque toward a direction, of a motor that turns that way at this share of its
/// no-load speed, as a share of the stall torque.
double LargestShare(const Servo& servo, double speed_share) noexcept {
  const double at_voltage = std::clamp(1.0 - speed_share, -1.0, 1.0);
  if (servo.current_share >= 1.0) return at_voltage;
  const double at_current =
      servo.limits_supply
          ? 0.5 * (std::hypot(speed_share, 2.0 * std::sqrt(servo.current_share)) - speed_share)
          : servo.current_share;
  return std::min(at_voltage, at_current);
}

}  // namespace

ServoTorque ComputeServoTorque(const Servo& servo, double target_rad, double angle_rad,
                               double speed_rad_s) noexcept {
  GAUNTLET_ASSERT(servo.stall_torque_nm > 0.0 && servo.no_load_speed_rad_s > 0.0 &&
                  servo.current_share > 0.0);
  const double error = target_rad - angle_rad;
  const double beyond = std::copysign(std::max(0.0, std::abs(error) - servo.dead_band_rad), error);
  const double wanted = servo.gain_nm_rad * beyond - servo.damping_nm_s_rad * speed_rad_s;

  const double speed_share = speed_rad_s / servo.no_load_speed_rad_s;
  const double most = servo.stall_torque_nm * LargestShare(servo, speed_share);
  const double least = -servo.stall_torque_nm * LargestShare(servo, -speed_share);
  const double torque = std::clamp(wanted, least, most);
  return {torque, torque != wanted};
}

}  // namespace gauntlet::sim
