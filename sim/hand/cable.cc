#include "sim/hand/cable.h"

#include <algorithm>
#include <cmath>

#include "controller/assert.h"

namespace gauntlet::sim {
namespace {

/// Below it tension falls in proportion to the bend.
constexpr double kSmallLogRatio = 1e-6;

}  // namespace

double CableTension(double stiffness_n_m, double damping_n_s_m, double stretch_m,
                    double stretch_rate_m_s) noexcept {
  if (!(stretch_m > 0.0)) return 0.0;
  const double elastic = stiffness_n_m * stretch_m;
  return elastic + std::clamp(damping_n_s_m * stretch_rate_m_s, -elastic, elastic);
}

void PullCable(const Cord& cord, double bend_rad, double stretch_m, double step_s,
               std::span<CablePlace> places, CableState& state) noexcept {
  GAUNTLET_ASSERT(cord.stiffness_n_m > 0.0 && step_s > 0.0);
  const bool linear = std::abs(state.log_ratio) < kSmallLogRatio;
  const double whole = linear ? 1.0 : std::expm1(state.log_ratio);
  double rate = 0.0;
  double speed = 0.0;  // towards the drum
  for (CablePlace& place : places) {
    const double lost =
        linear ? place.bend_share : std::expm1(place.bend_share * state.log_ratio) / whole;  // w
    rate += place.speed_m_s;
    speed += (0.5 - lost) * place.speed_m_s;
    place.pull_n = lost;
  }
  const double mean = CableTension(cord.stiffness_n_m, cord.damping_n_s_m, stretch_m, rate);
  const double turn = 0.5 * cord.friction_coefficient * std::max(0.0, bend_rad);
  const double most = 2.0 * mean * std::tanh(turn);
  state.difference_n =
      std::clamp(state.difference_n + 4.0 * cord.stiffness_n_m * speed * step_s, -most, most);
  const double difference =
      std::clamp(state.difference_n + 4.0 * cord.damping_n_s_m * speed, -most, most);
  const double at_drum = mean + 0.5 * difference;
  for (CablePlace& place : places) place.pull_n = at_drum - place.pull_n * difference;
  state.tension_n = at_drum;
  state.stretch_m = std::max(0.0, stretch_m);
  const double far = mean - 0.5 * difference;
  state.log_ratio = far > 0.0 ? std::log(far / at_drum) : 0.0;
}

double CableEnergy(const Cord& cord, const CableState& state) noexcept {
  return 0.5 * cord.stiffness_n_m * state.stretch_m * state.stretch_m +
         state.difference_n * state.difference_n / (8.0 * cord.stiffness_n_m);
}

double DrumAngle(double shaft_rad, double balance_rad, double play_rad) noexcept {
  GAUNTLET_ASSERT(play_rad >= 0.0);
  return std::clamp(balance_rad, shaft_rad - 0.5 * play_rad, shaft_rad + 0.5 * play_rad);
}

}  // namespace gauntlet::sim
