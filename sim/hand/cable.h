#pragma once

#include <span>

namespace gauntlet::sim {

/// The tension of an elastic cable: no push, and no jump where it becomes taut. Where it rubs, the
/// mean of its ends.
///
///     tension = k s + clamp(d ds/dt, -k s, k s)    for a stretch s > 0, else 0
///
/// The damping share is bounded by the elastic share, so tension is never negative and starts at 0.
/// Units: N, m, m/s, N/m, N s/m.
double CableTension(double stiffness_n_m, double damping_n_s_m, double stretch_m,
                    double stretch_rate_m_s) noexcept;

/// Properties of a cable from end to end.
struct Cord {
  double stiffness_n_m = 0.0;  // EA/L
  double damping_n_s_m = 0.0;
  double friction_coefficient = 0.0;  // where it bends

  /// How many times stiffer than the whole an end is while friction holds the cable.
  double EndFactor() const { return friction_coefficient > 0.0 ? 2.0 : 1.0; }
};

/// A place where a cable pulls: its drum, or a joint that it passes.
struct CablePlace {
  double bend_share = 0.0;  // of the cable's whole bend, between the drum and here
  double speed_m_s = 0.0;   // with which the cable becomes longer here
  double pull_n = 0.0;      // the answer of PullCable()
};

struct CableState {
  double difference_n = 0.0;  // D, while the cable does not move
  double log_ratio = 0.0;     // of the tensions at its far end and at its drum
  double tension_n = 0.0;     // at its drum
  double stretch_m = 0.0;     // none while it is slack
};

/// A cable over one time step: dry friction where it bends, as if all of it stood between the two
/// halves of the cable. While it holds, each end stretches its own half, which is twice as stiff as
/// the whole:
///
///     T_drum = T + D / 2,   T_far = T - D / 2        T: CableTension() of the whole stretch
///     dD/dt = 4 k v         while |D| < 2 T tanh(mu angle / 2), which is T_drum / T_far =
///                           exp(mu angle), the capstan (Euler-Eytelwein) equation; else it slides
///
/// In between tension falls exponentially with the bend: a place has lost the share
///
///     w = (1 - q^bend_share) / (1 - q) of D,  q = T_far / T_drum
///
/// and moves the cable towards its drum by v = sum over places of (1/2 - w) speed. So the energy
/// k s^2 / 2 + D^2 / (8 k) takes up all the work of all places but that of sliding, |D| times the
/// way, which is never negative: no motion and no setting gets energy out of it. Damping adds
/// 4 d v to D, within the same bounds. No place pulls with more than 2 T.
void PullCable(const Cord& cord, double bend_rad, double stretch_m, double step_s,
               std::span<CablePlace> places, CableState& state) noexcept;

/// Energy that a cable can give back [J].
double CableEnergy(const Cord& cord, const CableState& state) noexcept;

/// Angle of a drum with play on its shaft [rad]. It has no mass: where the play allows, it turns to
/// where both cables pull alike, `balance_rad`; else the shaft takes it along.
double DrumAngle(double shaft_rad, double balance_rad, double play_rad) noexcept;

}  // namespace gauntlet::sim
