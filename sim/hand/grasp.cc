#include "sim/hand/grasp.h"

#include <mujoco/mujoco.h>

#include <cmath>
#include <memory>

#include "sim/base/error.h"
#include "sim/hand/drive.h"
#include "sim/hand/mujoco_versions.h"

namespace gauntlet::sim {
namespace {

/// Distance at which the cylinder's near side passes the palm, from the wrist's deviation axis [m]:
/// it lies along the base of the thumb. The gap leaves space for the palm's padding.
constexpr double kSideFromWristM = 0.038;
constexpr double kPalmThicknessM = 0.0105;
constexpr double kGapM = 0.004;

/// The size of a geom and the radius of its bounding sphere, which the engine does not update.
void Resize(mjModel& model, int geom, double radius_m, double half_length_m) {
  model.geom_size[3 * geom] = radius_m;
  model.geom_size[3 * geom + 1] = half_length_m;
  model.geom_rbound[geom] = model.geom_type[geom] == mjGEOM_CAPSULE
                                ? radius_m + half_length_m
                                : std::hypot(radius_m, half_length_m);
}

}  // namespace

GraspParts MakeObject(mjModel& model, const ObjectConfig& config) {
  GraspParts grasp;
  grasp.object_body = FindInModel(model, mjOBJ_BODY, "object");
  grasp.palm_body = FindInModel(model, mjOBJ_BODY, "palm");
  grasp.skin_geom = FindInModel(model, mjOBJ_GEOM, "object_skin");
  grasp.foot_geom = FindInModel(model, mjOBJ_GEOM, "object_foot");
  grasp.support_half_height_m = model.geom_size[3 * FindInModel(model, mjOBJ_GEOM, "support") + 2];
  grasp.support_mocap = model.body_mocapid[FindInModel(model, mjOBJ_BODY, "support")];
  grasp.qpos = model.jnt_qposadr[FindInModel(model, mjOBJ_JOINT, "object")];
  const int shown = FindInModel(model, mjOBJ_GEOM, "object");
  grasp.radius_m = 0.5e-3 * config.diameter_mm;
  grasp.half_height_m = model.geom_size[3 * shown + 1];

  Resize(model, shown, grasp.radius_m, grasp.half_height_m);
  Resize(model, grasp.skin_geom, grasp.radius_m, grasp.half_height_m - grasp.radius_m);
  model.geom_friction[3 * grasp.skin_geom] = config.friction;
  // The larger friction of two geoms counts unless one has priority.
  model.geom_priority[grasp.skin_geom] = 1;

  model.body_mass[grasp.object_body] = config.mass_kg;
  const double r2 = grasp.radius_m * grasp.radius_m;
  const double h2 = 4.0 * grasp.half_height_m * grasp.half_height_m;
  mjtNum* inertia = model.body_inertia + 3 * grasp.object_body;
  inertia[0] = inertia[1] = config.mass_kg * (3.0 * r2 + h2) / 12.0;
  inertia[2] = 0.5 * config.mass_kg * r2;
  const std::unique_ptr<mjData, void (*)(mjData*)> data(mj_makeData(&model), &mj_deleteData);
  if (data == nullptr) throw RunError("not enough memory for the hand's model");
  mj_setConst(&model, data.get());
  return grasp;
}

void PlaceObject(const GraspParts& grasp, mjData& data) {
  const mjtNum in_palm[3] = {kSideFromWristM + grasp.radius_m, 0.0,
                             -(kPalmThicknessM + kGapM + grasp.radius_m)};
  mjtNum* position = data.qpos + grasp.qpos;
  MulMatVec3(position, data.xmat + 9 * grasp.palm_body, in_palm);
  mju_addTo3(position, data.xpos + 3 * grasp.palm_body);
  mjtNum* attitude = position + 3;
  attitude[0] = 1.0;
  attitude[1] = attitude[2] = attitude[3] = 0.0;

  mjtNum* support = data.mocap_pos + 3 * grasp.support_mocap;
  mju_copy3(support, position);
  support[2] -= grasp.half_height_m + grasp.support_half_height_m;
}

ObjectForces ForcesOnObject(const mjModel& model, const GraspParts& grasp,
                            const mjData& data) noexcept {
  ObjectForces forces;
  mjtNum carried[3] = {};
  for (int index = 0; index < data.ncon; ++index) {
    const mjContact& contact = data.contact[index];
    const auto touches = [&contact](int geom) {
      return contact.geom1 == geom || contact.geom2 == geom;
    };
    if (!touches(grasp.skin_geom) && !touches(grasp.foot_geom)) continue;
    mjtNum force[6];  // of the first geom on the second, in the frame of the contact
    mj_contactForce(&model, &data, index, force);
    if (!touches(grasp.skin_geom)) {
      forces.support_n += force[0];
      continue;
    }
    forces.grip_n += force[0];
    mjtNum in_world[3];
    MulMatTVec3(in_world, contact.frame, force);
    mju_addToScl3(carried, in_world, contact.geom2 == grasp.skin_geom ? 1.0 : -1.0);
  }
  forces.carried_n = mju_norm3(carried);
  return forces;
}

}  // namespace gauntlet::sim
