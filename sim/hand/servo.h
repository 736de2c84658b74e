#pragma once

namespace gauntlet::sim {

/// A position servo with a DC motor behind it.
///
///     wanted    = gain beyond(target - angle) - damping speed
///     available = stall_torque (1 - speed / no_load_speed), at most stall_torque, when it drives
///                 forward; the mirror image when it drives backward
///
/// where beyond(e) is what e has beyond the dead band. Back-EMF is the torque-speed line. A limit
/// of the current to the share i of the stall current bounds the torque, at the speed
/// x = speed / no_load_speed, to
///
///     stall_torque i                              if the current of the motor is limited
///     stall_torque (sqrt(x^2 + 4 i) - x) / 2      if that of the supply is
///
/// in the direction of the motion, and to the mirror image against it. The second is what a duty
/// cycle u that takes i = u (u - x) leaves (Rhoban/bam, XL330). Units: N m, rad, s.
struct Servo {
  double gain_nm_rad = 0.0;
  double damping_nm_s_rad = 0.0;
  double dead_band_rad = 0.0;
  double stall_torque_nm = 0.0;
  double no_load_speed_rad_s = 1.0;
  double current_share = 1.0;  // of the stall current, above 0
  bool limits_supply = false;  // the limit is on the supply's current, not on the motor's
};

struct ServoTorque {
  double torque_nm = 0.0;
  bool saturated = false;  // less than wanted
};

ServoTorque ComputeServoTorque(const Servo& servo, double target_rad, double angle_rad,
                               double speed_rad_s) noexcept;

}  // namespace gauntlet::sim
