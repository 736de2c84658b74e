#pragma once

#include <span>

#include "sim/score/fourier.h"
#include "sim/score/wearer.h"

namespace gauntlet::sim {

/// Spectral arc length of a speed profile: the length of its normalised amplitude spectrum between
/// 0 and at most 10 Hz. Nearer to 0 is smoother.
///
///     sparc = -sum sqrt((df / band)^2 + (d|V(f)| / |V|max)^2)
///
/// The profile is padded with zeros to 16 times the next power of two. The band ends where the
/// amplitude was last at 5 % of the largest. NaN without any motion.
/// Source: Balasubramanian, Melendez-Calderon, Roby-Brami, Burdet 2015, doi
/// 10.1186/s12984-015-0090-9; parameters and the checked value: their program (siva82kb/SPARC).
double SpectralArcLength(std::span<const double> speed, double rate_hz, Fourier& fourier);

/// Log dimensionless jerk of a speed profile. Nearer to 0 is smoother.
///
///     ldlj = -ln(T^3 / v_peak^2 * integral of (d^2 v/dt^2)^2 dt)
///
/// NaN below three samples or without any motion. Source: as above.
double LogDimensionlessJerk(std::span<const double> speed, double rate_hz);

/// Smoothness of the hand in the wearer's movements, the mean over movements.
struct Smoothness {
  double sparc;
  double ldlj;
};

/// Both are made for single movements, so the hand's velocity is cut where the wearer's movements
/// begin and end, later by the delay to the nearest tick. It is taken behind a zero-phase low pass
/// of 20 Hz (10 to 30 Hz) every 10 ms or so from the begin of the cut on: the rate of the published
/// program, and as for any third derivative of a measured angle. Movements below 0.2 s do not
/// count. NaN where there is none.
/// Units: rad, samples. Shapes: `hand_angle_rad` has the wearer's samples.
Smoothness MovementSmoothness(std::span<const double> hand_angle_rad, double rate_hz,
                              std::span<const Movement> movements, double delay_samples,
                              Fourier& fourier);

}  // namespace gauntlet::sim
