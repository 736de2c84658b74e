#include "sim/hand/physics_model.h"

#include <fmt/core.h>
#include <mujoco/mjxmacro.h>
#include <mujoco/mujoco.h>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cstring>
#include <utility>

#include "sim/base/error.h"
#include "sim/hand/mujoco_versions.h"

namespace gauntlet::sim {
namespace {

using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;

/// True if a tendon does more than a cable, whose pull the hand computes.
bool TendonsActByThemselves(const mjModel& model) {
  for (int tendon = 0; tendon < model.ntendon; ++tendon) {
    if (model.tendon_stiffness[tendon] > 0.0 || model.tendon_damping[tendon] > 0.0 ||
        model.tendon_limited[tendon] || model.tendon_frictionloss[tendon] > 0.0) {
      return true;
    }
  }
  return std::count(model.eq_type, model.eq_type + model.neq, mjEQ_TENDON) > 0;
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

bool HasSpool(const std::vector<Drive>& drives, int dof) {
  return std::ranges::find(drives, dof, &Drive::spool_dof) != drives.end();
}

/// Errors: UserError for a spool that is no hinge or is coupled to something else than its cables.
void CheckSpools(const mjModel& model, const std::vector<Drive>& drives) {
  const auto refuse = [&model](int joint, const char* problem) {
    throw UserError(
        fmt::format("joint '{}' of the model {}", mj_id2name(&model, mjOBJ_JOINT, joint), problem));
  };
  for (const Drive& drive : drives) {
    if (drive.spool_dof < 0) continue;
    const int joint = model.dof_jntid[drive.spool_dof];
    if (model.jnt_type[joint] != mjJNT_HINGE) refuse(joint, "must be a hinge: it is a spool");
  }
  for (int index = 0; index < model.nwrap; ++index) {
    const int joint = model.wrap_objid[index];
    if (model.wrap_type[index] == mjWRAP_JOINT && HasSpool(drives, model.jnt_dofadr[joint])) {
      refuse(joint, "is a spool: no tendon may go by its angle");
    }
  }
  for (int index = 0; index < model.neq; ++index) {
    if (model.eq_type[index] != mjEQ_JOINT) continue;
    for (const int joint : {model.eq_obj1id[index], model.eq_obj2id[index]}) {
      if (joint >= 0 && HasSpool(drives, model.jnt_dofadr[joint])) {
        refuse(joint, "is a spool: only its motor and its cables may turn it, no equality");
      }
    }
  }
}

struct Inertia {
  double mass_kg;
  Vector3d center_m;  // in the frame of a body
  Matrix3d about_center_kg_m2;

  /// Inertia about a point at `to` from the center.
  Matrix3d About(const Vector3d& to) const {
    return about_center_kg_m2 +
           mass_kg * (to.squaredNorm() * Matrix3d::Identity() - to * to.transpose());
  }
};

Quaterniond Attitude(const mjtNum* q) { return {q[0], q[1], q[2], q[3]}; }
Eigen::Map<Vector3d> Vector(mjtNum* numbers) { return Eigen::Map<Vector3d>(numbers); }

/// In the body's own frame.
Inertia InertiaOf(const mjModel& model, int body) {
  const Matrix3d axes = Attitude(model.body_iquat + 4 * body).toRotationMatrix();
  return {model.body_mass[body], Vector(model.body_ipos + 3 * body),
          axes * Vector(model.body_inertia + 3 * body).asDiagonal() * axes.transpose()};
}

/// Makes a body that does not move against its parent a part of it.
void AddToParent(mjModel& model, int body) {
  const int parent = model.body_parentid[body];
  if (parent == 0) return;  // the world does not move
  const Quaterniond attitude = Attitude(model.body_quat + 4 * body);
  const Matrix3d turned = attitude.toRotationMatrix();
  Inertia part = InertiaOf(model, body);
  part.center_m = Vector(model.body_pos + 3 * body) + turned * part.center_m;
  part.about_center_kg_m2 = turned * part.about_center_kg_m2 * turned.transpose();
  const Inertia before = InertiaOf(model, parent);
  const double mass = before.mass_kg + part.mass_kg;
  const Vector3d center = (before.mass_kg * before.center_m + part.mass_kg * part.center_m) / mass;
  const Eigen::SelfAdjointEigenSolver<Matrix3d> principal(before.About(center - before.center_m) +
                                                          part.About(center - part.center_m));
  Matrix3d axes = principal.eigenvectors();
  if (axes.determinant() < 0.0) axes.col(0) *= -1.0;
  const Quaterniond axes_attitude(axes);
  model.body_mass[parent] = mass;
  Vector(model.body_ipos + 3 * parent) = center;
  Vector(model.body_inertia + 3 * parent) = principal.eigenvalues();
  mjtNum* quaternion = model.body_iquat + 4 * parent;
  quaternion[0] = axes_attitude.w();
  Vector(quaternion + 1) = axes_attitude.vec();
  // Its center of mass is not where its origin is.
  model.body_sameframe[parent] = 0;
  model.body_simple[parent] = 0;
}

/// Number of parts of each body, and the first of them; the parts are in the order of their bodies.
void CountPerBody(const int* body_of, int count, int bodies, int* number, int* first) {
  std::fill_n(number, bodies, 0);
  std::fill_n(first, bodies, -1);
  for (int part = 0; part < count; ++part) {
    if (number[body_of[part]]++ == 0) first[body_of[part]] = part;
  }
}

/// The bodies in the key by which the engine sorts pairs of them.
std::pair<int, int> BodiesOf(int signature) {
  return {(signature >> 16) - 1, (signature & 0xffff) - 1};
}

}  // namespace

PhysicsModel::Rows PhysicsModel::Keep(const std::vector<bool>& kept) {
  Rows rows;
  rows.index_of.assign(kept.size(), -1);
  for (std::size_t i = 0; i < kept.size(); ++i) {
    if (!kept[i]) continue;
    rows.index_of[i] = static_cast<int>(rows.kept.size());
    rows.kept.push_back(static_cast<int>(i));
  }
  return rows;
}

void PhysicsModel::Number(int* ids, int count, const Rows& rows) {
  for (int i = 0; i < count; ++i) {
    if (ids[i] >= 0) ids[i] = rows.index_of[ids[i]];
  }
}

template <class Value>
void PhysicsModel::Select(Value*& rows, int columns, const std::vector<int>& kept) {
  const std::size_t row_bytes = sizeof(Value) * columns;
  auto& copy = arrays_.emplace_back(new std::byte[row_bytes * kept.size() + 1]);
  for (std::size_t i = 0; i < kept.size(); ++i) {
    std::memcpy(copy.get() + i * row_bytes, rows + std::ptrdiff_t{columns} * kept[i], row_bytes);
  }
  rows = reinterpret_cast<Value*>(copy.get());
}

/// In all arrays that have a row for each of what `count_name` counts.
void PhysicsModel::SelectRows(std::string_view count_name, const Rows& rows) {
  MJMODEL_POINTERS_PREAMBLE(model_.get())
#define X(type, name, count, columns) \
  if (count_name == #count) Select(model_->name, columns, rows.kept);
  MJMODEL_POINTERS
#undef X
}

PhysicsModel::PhysicsModel(const mjModel& whole, const std::vector<Drive>& drives,
                           bool engine_measures_cables)
    : PhysicsModel(whole, drives, engine_measures_cables,
                   kModelsCanBeCut ? Spools::kCutOut : Spools::kStandStill) {}

PhysicsModel::PhysicsModel(const mjModel& whole, const std::vector<Drive>& drives,
                           bool engine_measures_cables, Spools spools)
    : model_(nullptr, &mj_deleteModel) {
  CheckSpools(whole, drives);
  const bool tendons = engine_measures_cables || TendonsActByThemselves(whole);
  spools == Spools::kCutOut ? Cut(whole, drives, tendons) : Hold(whole, drives, tendons);
}

PhysicsModel::~PhysicsModel() = default;

/// Sensors, actuators and the like: nothing moves because of them.
void PhysicsModel::LeaveOutAids(bool tendons) {
  mjModel& model = *model_;
  model.ncam = model.nlight = model.nsensor = model.nsensordata = model.nkey = 0;
  LeaveOutActuators(model);  // the hand turns the spools itself
  if (!tendons) model.ntendon = model.nwrap = 0;
}

/// Makes spools part of what carries them by a damping that no torque overcomes. An inertia would,
/// too, but later engines let the solver be the coarser, the larger the sum of inertias is.
void PhysicsModel::Hold(const mjModel& whole, const std::vector<Drive>& drives, bool tendons) {
  constexpr double kHeld_nm_s_rad = 1e6;
  model_.reset(mj_copyModel(nullptr, &whole));
  if (model_ == nullptr) throw RunError("not enough memory for the hand's model");
  mjModel& model = *model_;
  LeaveOutAids(tendons);
  const auto all = [](int count) { return Keep(std::vector<bool>(count, true)); };
  bodies_ = all(model.nbody);
  joints_ = all(model.njnt);
  dofs_ = all(model.nv);
  positions_ = all(model.nq);
  geoms_ = all(model.ngeom);
  for (const Drive& drive : drives) {
    const int dof = drive.spool_dof;
    if (dof < 0) continue;
    const int joint = model.dof_jntid[dof];
    model.dof_damping[dof] = kHeld_nm_s_rad;
    model.dof_frictionloss[dof] = model.jnt_stiffness[joint] = 0.0;
    model.jnt_limited[joint] = 0;
    dofs_.index_of[dof] = positions_.index_of[model.jnt_qposadr[joint]] = -1;
  }
}

void PhysicsModel::Cut(const mjModel& whole, const std::vector<Drive>& drives, bool tendons) {
  model_ = {new mjModel(whole), [](mjModel* model) { delete model; }};
  mjModel& model = *model_;
  LeaveOutAids(tendons);
  if (!tendons) model.nsite = 0;
  const std::vector<bool> acting =
      tendons ? std::vector<bool>(whole.ngeom, true) : ActingGeoms(whole);

  std::vector<bool> joint(whole.njnt), dof(whole.nv), position(whole.nq, true);
  for (int i = 0; i < whole.nv; ++i) dof[i] = !HasSpool(drives, i);
  for (int i = 0; i < whole.njnt; ++i) {
    joint[i] = dof[whole.jnt_dofadr[i]];
    if (!joint[i]) position[whole.jnt_qposadr[i]] = false;
  }
  // A spool that carries nothing and touches nothing becomes a part of what carries it.
  std::vector<bool> body(whole.nbody, true), needed(whole.nbody, tendons);
  for (int i = 1; i < whole.nbody; ++i) needed[whole.body_parentid[i]] = true;
  for (int i = 0; i < whole.ngeom; ++i) {
    if (acting[i]) needed[whole.geom_bodyid[i]] = true;
  }
  for (int i = 0; i < whole.neq; ++i) {
    if (whole.eq_type[i] != mjEQ_CONNECT && whole.eq_type[i] != mjEQ_WELD) continue;
    needed[whole.eq_obj1id[i]] = needed[whole.eq_obj2id[i]] = true;
  }
  for (const Drive& drive : drives) {
    if (drive.spool_dof < 0) continue;
    const int spool = whole.dof_bodyid[drive.spool_dof];
    body[spool] = needed[spool] || whole.body_jntnum[spool] > 1;
  }
  bodies_ = Keep(body);
  joints_ = Keep(joint);
  dofs_ = Keep(dof);
  positions_ = Keep(position);
  geoms_ = Keep(acting);

  SelectRows("nbody", Keep(std::vector<bool>(whole.nbody, true)));  // a copy that may change
  for (int i = whole.nbody - 1; i > 0; --i) {
    if (!body[i]) AddToParent(model, i);
  }
  SelectRows("nbody", bodies_);
  SelectRows("njnt", joints_);
  SelectRows("nv", dofs_);
  SelectRows("nq", positions_);
  SelectRows("ngeom", geoms_);
  model.nbody = std::ssize(bodies_.kept);
  model.njnt = std::ssize(joints_.kept);
  model.nv = std::ssize(dofs_.kept);
  model.nq = std::ssize(positions_.kept);
  model.ngeom = std::ssize(geoms_.kept);
  NumberParts(whole);
  NumberConstraints(whole);
}

/// Bodies, joints and degrees of freedom name each other by number.
void PhysicsModel::NumberParts(const mjModel& whole) {
  mjModel& model = *model_;
  Number(model.body_parentid, model.nbody, bodies_);
  Number(model.body_rootid, model.nbody, bodies_);
  Number(model.jnt_bodyid, model.njnt, bodies_);
  Number(model.jnt_qposadr, model.njnt, positions_);
  Number(model.jnt_dofadr, model.njnt, dofs_);
  Number(model.dof_bodyid, model.nv, bodies_);
  Number(model.dof_jntid, model.nv, joints_);
  Number(model.geom_bodyid, model.ngeom, bodies_);
  CountPerBody(model.jnt_bodyid, model.njnt, model.nbody, model.body_jntnum, model.body_jntadr);
  CountPerBody(model.dof_bodyid, model.nv, model.nbody, model.body_dofnum, model.body_dofadr);
  CountPerBody(model.geom_bodyid, model.ngeom, model.nbody, model.body_geomnum, model.body_geomadr);
  for (int body = 1; body < model.nbody; ++body) {
    // A body without a joint is welded to what carries it.
    model.body_weldid[body] =
        model.body_jntnum[body] > 0 ? body : model.body_weldid[model.body_parentid[body]];
  }
  // The inertia matrix has a row per degree of freedom, with all that carry it.
  std::vector<int> depth(model.nv);
  model.nM = 0;
  for (int dof = 0; dof < model.nv; ++dof) {
    int parent = whole.dof_parentid[dofs_.kept[dof]];
    while (parent >= 0 && dofs_.index_of[parent] < 0) parent = whole.dof_parentid[parent];
    model.dof_parentid[dof] = parent < 0 ? -1 : dofs_.index_of[parent];
    depth[dof] = 1 + (parent < 0 ? 0 : depth[model.dof_parentid[dof]]);
    model.dof_Madr[dof] = model.nM;
    model.nM += depth[dof];
  }
  model.nD = 2 * model.nM - model.nv;
  for (int dof = model.nv - 1; dof >= 0; --dof) {
    const int after = dof + 1 < model.nv ? model.dof_simplenum[dof + 1] : 0;
    model.dof_simplenum[dof] = model.body_simple[model.dof_bodyid[dof]] ? 1 + after : 0;
  }
}

/// Constraints that couple parts, touch or leave out contacts.
void PhysicsModel::NumberConstraints(const mjModel& whole) {
  mjModel& model = *model_;
  const auto own = [this](int*& ids, int count) {
    Select(ids, 1, Keep(std::vector<bool>(count, true)).kept);
  };
  own(model.eq_obj1id, model.neq);
  own(model.eq_obj2id, model.neq);
  for (int index = 0; index < model.neq; ++index) {
    const Rows* parts = whole.eq_type[index] == mjEQ_JOINT      ? &joints_
                        : whole.eq_type[index] == mjEQ_DISTANCE ? &geoms_
                        : whole.eq_type[index] == mjEQ_TENDON   ? nullptr
                                                                : &bodies_;
    if (parts == nullptr) continue;
    Number(model.eq_obj1id + index, 1, *parts);
    Number(model.eq_obj2id + index, 1, *parts);
  }
  own(model.wrap_objid, model.nwrap);
  for (int index = 0; index < model.nwrap; ++index) {
    if (model.wrap_type[index] == mjWRAP_JOINT) Number(model.wrap_objid + index, 1, joints_);
  }
  if ((model.opt.disableflags & mjDSBL_CONTACT) != 0) model.npair = 0;
  own(model.pair_geom1, model.npair);
  own(model.pair_geom2, model.npair);
  own(model.pair_signature, model.npair);
  Number(model.pair_geom1, model.npair, geoms_);
  Number(model.pair_geom2, model.npair, geoms_);
  for (int index = 0; index < model.npair; ++index) NumberSignature(model.pair_signature[index]);
  std::vector<bool> excludes(model.nexclude);
  for (int index = 0; index < model.nexclude; ++index) {
    const auto [first, second] = BodiesOf(whole.exclude_signature[index]);
    excludes[index] = bodies_.index_of[first] >= 0 && bodies_.index_of[second] >= 0;
  }
  const Rows kept = Keep(excludes);
  SelectRows("nexclude", kept);
  model.nexclude = std::ssize(kept.kept);
  for (int index = 0; index < model.nexclude; ++index) {
    NumberSignature(model.exclude_signature[index]);
  }
}

void PhysicsModel::NumberSignature(int& signature) const {
  const auto [first, second] = BodiesOf(signature);
  signature = ((bodies_.index_of[first] + 1) << 16) + bodies_.index_of[second] + 1;
}

void PhysicsModel::CopyPositions(const double* whole_qpos, double* qpos) const {
  for (std::size_t i = 0; i < positions_.index_of.size(); ++i) {
    if (positions_.index_of[i] >= 0) qpos[positions_.index_of[i]] = whole_qpos[i];
  }
}

}  // namespace gauntlet::sim
