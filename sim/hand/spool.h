#pragma once

namespace gauntlet::sim {

/// Parts that turn behind the gear of a motor, as felt at its drum: rotor, gear and drum.
struct Spool {
  double inertia_kg_m2 = 1.0;
  double damping_nm_s_rad = 0.0;
  double dry_friction_nm = 0.0;
  double load_friction = 0.0;  // share of the load that the gear adds to its dry friction
};

struct SpoolState {
  double angle_rad = 0.0;
  double speed_rad_s = 0.0;
};

/// One time step of a spool that its servo drives and its cables load, a torque against its angle:
///
///     inertia dw/dt = drive - load - damping w - friction,  friction = f sign(w)
///     f = dry_friction + load_friction |load|
///
/// Source of f: model M3 of Duclusaud, Passault, Padois, Ly, Extended Friction Models for the
/// Physics Simulation of Servo Actuators, arXiv:2410.08650 (2024).
/// Damping and friction are those of the step's end. So a spool that rests stands exactly still
/// until drive and load differ by more than f, and friction never turns it back.
void TurnSpool(const Spool& spool, double drive_nm, double load_nm, double step_s,
               SpoolState& state) noexcept;

}  // namespace gauntlet::sim
