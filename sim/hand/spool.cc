#include "sim/hand/spool.h"

#include <algorithm>
#include <cmath>

#include "controller/assert.h"

namespace gauntlet::sim {

void TurnSpool(const Spool& spool, double drive_nm, double load_nm, double step_s,
               SpoolState& state) noexcept {
  GAUNTLET_ASSERT(step_s > 0.0 && spool.inertia_kg_m2 > 0.0);
  const double inertia = spool.inertia_kg_m2 + step_s * spool.damping_nm_s_rad;
  const double without_friction =
      spool.inertia_kg_m2 * state.speed_rad_s + step_s * (drive_nm - load_nm);
  const double friction = spool.dry_friction_nm + spool.load_friction * std::abs(load_nm);
  const double left = std::max(0.0, std::abs(without_friction) - step_s * friction);
  state.speed_rad_s = std::copysign(left, without_friction) / inertia;
  state.angle_rad += step_s * state.speed_rad_s;
}

}  // namespace gauntlet::sim
