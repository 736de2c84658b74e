#pragma once

namespace gauntlet::sim {

/// A position servo with a DC motor behind it.
///
///     wanted    = gain beyond(target - angle) - damping speed
///     available = stall_torque (1 - speed / no_load_speed), at most stall_torque, when it drives
///                 forward; the mirror image when it drives backward
///
/// where beyond(e) is what e has beyond the dead band. Back-EMF is the torque-speed line; the
/// current limit keeps braking at the stall torque. Units: N m, rad, s.
struct Servo {
  double gain_nm_rad = 0.0;
  double damping_nm_s_rad = 0.0;
  double dead_band_rad = 0.0;
  double stall_torque_nm = 0.0;
  double no_load_speed_rad_s = 1.0;
};

struct ServoTorque {
  double torque_nm = 0.0;
  bool saturated = false;  // less than wanted
};

ServoTorque ComputeServoTorque(const Servo& servo, double target_rad, double angle_rad,
                               double speed_rad_s) noexcept;

}  // namespace gauntlet::sim
