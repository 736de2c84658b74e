#pragma once

namespace gauntlet::sim {

/// The pull of an elastic cable: no push, and no jump where it becomes taut.
///
///     tension = k s + clamp(d ds/dt, -k s, k s)    for a stretch s > 0, else 0
///
/// The damping share is bounded by the elastic share, so tension is never negative and starts at 0.
/// Units: N, m, m/s, N/m, N s/m.
double CableTension(double stiffness_n_m, double damping_n_s_m, double stretch_m,
                    double stretch_rate_m_s) noexcept;

/// Travel over which friction builds up when a cable reverses [m]. An assumption: about one strand
/// of a 0.6 mm cord.
inline constexpr double kPreslidingTravelM = 2e-4;

/// State of dry friction in [-1, 1] after the cable has moved by `travel_m` towards its drum:
/// 1 while it is pulled in, -1 while it is pulled out, and in between it holds. The exact solution
/// for one step of constant speed of
///
///     dz/dt = v / presliding_travel (1 - z sign(v))
///
/// Source: Dahl (1968), A solid friction model; with the exponent 1.
double AdvanceFriction(double state, double travel_m) noexcept;

/// How many times larger the tension is on the side of the drum, after the cable has bent by
/// `angle_rad` in all.
///
///     T_drum / T_far = exp(mu angle z)
///
/// Source: the capstan (Euler-Eytelwein) equation, with the friction state z instead of a sign.
double CapstanRatio(double friction_coefficient, double angle_rad, double state) noexcept;

/// Where a drum with play stands on its shaft [rad]. It has no mass: where the play allows, it
/// turns to where both cables pull alike, `balance_rad`; else the shaft takes it along.
double DrumAngle(double shaft_rad, double balance_rad, double play_rad) noexcept;

}  // namespace gauntlet::sim
