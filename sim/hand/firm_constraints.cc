#include "sim/hand/firm_constraints.h"

#include <mujoco/mujoco.h>

#include <algorithm>
#include <iterator>

namespace gauntlet::sim {
namespace {

constexpr mjtNum kDefaultSolref[mjNREF] = {0.02, 1.0};
constexpr mjtNum kFirmSolref[mjNREF] = {0.004, 1.0};
constexpr mjtNum kDefaultSolimp[mjNIMP] = {0.9, 0.95, 0.001, 0.5, 2.0};
constexpr mjtNum kFirmSolimp[mjNIMP] = {0.9999, 0.99999, 0.001, 0.5, 2.0};

void Firm(mjtNum* solref, mjtNum* solimp, int index) {
  const auto replace = [](const auto& given, const auto& firm, mjtNum* numbers) {
    if (std::equal(std::begin(given), std::end(given), numbers)) std::ranges::copy(firm, numbers);
  };
  replace(kDefaultSolref, kFirmSolref, solref + mjNREF * index);
  replace(kDefaultSolimp, kFirmSolimp, solimp + mjNIMP * index);
}

}  // namespace

void FirmConstraints(mjModel& model, const std::vector<Drive>& drives) {
  for (int index = 0; index < model.neq; ++index) {
    const bool holds_bodies =
        model.eq_type[index] == mjEQ_CONNECT || model.eq_type[index] == mjEQ_WELD;
    if (holds_bodies) Firm(model.eq_solref, model.eq_solimp, index);
  }
  for (int dof = 0; dof < model.nv; ++dof) {
    const bool spool = std::ranges::find(drives, dof, &Drive::spool_dof) != drives.end();
    if (!spool && model.dof_frictionloss[dof] > 0.0) {
      Firm(model.dof_solref, model.dof_solimp, dof);
    }
  }
  for (int tendon = 0; tendon < model.ntendon; ++tendon) {
    if (model.tendon_frictionloss[tendon] > 0.0) {
      Firm(model.tendon_solref_fri, model.tendon_solimp_fri, tendon);
    }
  }
}

}  // namespace gauntlet::sim
