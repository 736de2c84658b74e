#include "sim/hand/cable.h"

#include <algorithm>
#include <cmath>

namespace gauntlet::sim {

double CableTension(double stiffness_n_m, double damping_n_s_m, double stretch_m,
                    double stretch_rate_m_s) noexcept {
  if (!(stretch_m > 0.0)) return 0.0;
  const double elastic = stiffness_n_m * stretch_m;
  return elastic + std::clamp(damping_n_s_m * stretch_rate_m_s, -elastic, elastic);
}

double AdvanceFriction(double state, double travel_m) noexcept {
  const double end = std::copysign(1.0, travel_m);
  return end + (state - end) * std::exp(-std::abs(travel_m) / kPreslidingTravelM);
}

double CapstanRatio(double friction_coefficient, double angle_rad, double state) noexcept {
  return std::exp(friction_coefficient * angle_rad * state);
}

double DrumAngle(double shaft_rad, double balance_rad, double play_rad) noexcept {
  return std::clamp(balance_rad, shaft_rad - 0.5 * play_rad, shaft_rad + 0.5 * play_rad);
}

}  // namespace gauntlet::sim
