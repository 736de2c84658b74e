#include "sim/hand/physics_model.h"

#include <mujoco/mjxmacro.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <cstring>
#include <numeric>
#include <string_view>

namespace gauntlet::sim {
namespace {

/// Whether a tendon does more than a cable whose pull the hand computes.
bool TendonsActByThemselves(const mjModel& model, const std::vector<Drive>& drives) {
  for (int tendon = 0; tendon < model.ntendon; ++tendon) {
    const bool cable = std::ranges::any_of(drives, [&](const Drive& drive) {
      return std::ranges::find(drive.cables, tendon, &Cable::tendon) != drive.cables.end();
    });
    if (!cable || model.tendon_limited[tendon] || model.tendon_frictionloss[tendon] > 0.0) {
      return true;
    }
  }
  return std::count(model.eq_type, model.eq_type + model.neq, mjEQ_TENDON) > 0;
}

bool ActuatorsPullAtJointsOnly(const mjModel& model) {
  return std::all_of(model.actuator_trntype, model.actuator_trntype + model.nu,
                     [](int type) { return type == mjTRN_JOINT || type == mjTRN_JOINTINPARENT; });
}

/// Per geom: whether something can touch it, or it moves against a fluid.
std::vector<bool> ActingGeoms(const mjModel& model) {
  const bool all = model.opt.density > 0.0 || model.opt.viscosity > 0.0 ||
                   std::count(model.eq_type, model.eq_type + model.neq, mjEQ_DISTANCE) > 0;
  const bool contacts = (model.opt.disableflags & mjDSBL_CONTACT) == 0;
  std::vector<bool> acts(model.ngeom, all);
  for (int geom = 0; geom < model.ngeom && contacts; ++geom) {
    if (model.geom_contype[geom] != 0 || model.geom_conaffinity[geom] != 0) acts[geom] = true;
  }
  for (int pair = 0; pair < model.npair && contacts; ++pair) {
    acts[model.pair_geom1[pair]] = acts[model.pair_geom2[pair]] = true;
  }
  return acts;
}

std::vector<int> Numbers(int count) {
  std::vector<int> numbers(count);
  std::iota(numbers.begin(), numbers.end(), 0);
  return numbers;
}

}  // namespace

PhysicsModel::PhysicsModel(const mjModel& whole, const std::vector<Drive>& drives,
                           bool engine_measures_cables)
    : model_(new mjModel(whole)) {
  mjModel& model = *model_;
  model.ncam = model.nlight = model.nsensor = model.nsensordata = 0;
  if (ActuatorsPullAtJointsOnly(whole) && !engine_measures_cables &&
      !TendonsActByThemselves(whole, drives)) {
    model.ntendon = model.nwrap = model.nsite = 0;
    KeepGeoms(ActingGeoms(whole));
  } else {
    KeepGeoms(std::vector<bool>(whole.ngeom, true));
  }
}

PhysicsModel::~PhysicsModel() = default;

template <class Number>
void PhysicsModel::Select(Number*& rows, int columns, const std::vector<int>& kept) {
  const std::size_t row_bytes = sizeof(Number) * columns;
  auto& copy = arrays_.emplace_back(new std::byte[row_bytes * kept.size() + 1]);
  for (std::size_t i = 0; i < kept.size(); ++i) {
    std::memcpy(copy.get() + i * row_bytes, rows + std::ptrdiff_t{columns} * kept[i], row_bytes);
  }
  rows = reinterpret_cast<Number*>(copy.get());
}

void PhysicsModel::KeepGeoms(const std::vector<bool>& kept) {
  mjModel& model = *model_;
  geom_of_.assign(model.ngeom, -1);
  Select(model.body_geomnum, 1, Numbers(model.nbody));
  Select(model.body_geomadr, 1, Numbers(model.nbody));
  std::fill_n(model.body_geomnum, model.nbody, 0);
  std::fill_n(model.body_geomadr, model.nbody, -1);
  std::vector<int> rows;
  for (int geom = 0; geom < model.ngeom; ++geom) {
    if (!kept[geom]) continue;
    geom_of_[geom] = static_cast<int>(rows.size());
    const int body = model.geom_bodyid[geom];
    if (model.body_geomnum[body]++ == 0) model.body_geomadr[body] = geom_of_[geom];
    rows.push_back(geom);
  }
  Select(model.pair_geom1, 1, Numbers(model.npair));
  Select(model.pair_geom2, 1, Numbers(model.npair));
  for (int pair = 0; pair < model.npair; ++pair) {
    model.pair_geom1[pair] = geom_of_[model.pair_geom1[pair]];
    model.pair_geom2[pair] = geom_of_[model.pair_geom2[pair]];
  }
  // Every array that has a row per geom.
  MJMODEL_POINTERS_PREAMBLE((&model))
  constexpr std::string_view kPerGeom = "ngeom";
#define X(type, name, count, columns) \
  if (kPerGeom == #count) Select(model.name, columns, rows);
  MJMODEL_POINTERS
#undef X
  model.ngeom = static_cast<int>(rows.size());
}

}  // namespace gauntlet::sim
