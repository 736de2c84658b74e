#include "sim/hand/hand_shapes.h"

#include <mujoco/mujoco.h>

#include <algorithm>

namespace gauntlet::sim {
namespace {

using Form = HandShapes::Form;

constexpr int kGroupsDrawn = 3;  // as mjv_defaultOption() has it

template <std::size_t count, class Number>
std::array<Number, count> CopyValues(const Number* values, int index) {
  std::array<Number, count> taken;
  std::copy_n(values + static_cast<std::ptrdiff_t>(count) * index, count, taken.begin());
  return taken;
}

Frame FrameAt(const mjtNum* position_m, const mjtNum* rotation, int index) {
  return {.position_m = CopyValues<3>(position_m, index),
          .rotation = CopyValues<4>(rotation, index)};
}

/// A material's colour holds unless the shape has one of its own.
std::array<float, 4> Colour(const mjModel& model, int material, const std::array<float, 4>& own) {
  constexpr std::array<float, 4> kDefault = {0.5f, 0.5f, 0.5f, 1.0f};
  return material >= 0 && own == kDefault ? CopyValues<4>(model.mat_rgba, material) : own;
}

std::optional<Form> FormOf(int type) {
  switch (type) {
    case mjGEOM_SPHERE:
      return Form::kSphere;
    case mjGEOM_CAPSULE:
      return Form::kCapsule;
    case mjGEOM_ELLIPSOID:
      return Form::kEllipsoid;
    case mjGEOM_CYLINDER:
      return Form::kCylinder;
    case mjGEOM_BOX:
      return Form::kBox;
    case mjGEOM_MESH:
      return Form::kMesh;
    default:
      return std::nullopt;
  }
}

void AddHinges(const HandModel& hand, HandShapes& shapes) {
  const mjModel& model = hand.model();
  const auto joint_at = [&hand](int qpos) {
    return static_cast<int>(std::ranges::find(hand.joints(), qpos, &HandJoint::qpos) -
                            hand.joints().begin());
  };
  const int joint_count = static_cast<int>(hand.joints().size());
  for (int index = 0; index < model.njnt; ++index) {  // where a body has several, in this order
    const int qpos = model.jnt_qposadr[index];
    HandShapes::Hinge hinge{.body = model.jnt_bodyid[index],
                            .joint = joint_at(qpos),
                            .position_m = CopyValues<3>(model.jnt_pos, index),
                            .axis = CopyValues<3>(model.jnt_axis, index),
                            .zero_rad = model.qpos0[qpos],
                            .coefficient = {}};
    const auto follower = std::ranges::find(hand.followers(), qpos, &Follower::qpos);
    if (follower != hand.followers().end()) {
      hinge.joint = joint_at(follower->leader_qpos);
      hinge.leader_zero_rad = follower->leader_zero_rad;
      hinge.coefficient.assign(std::begin(follower->coefficient), std::end(follower->coefficient));
    }
    if (hinge.joint < joint_count) shapes.hinges.push_back(hinge);
  }
}

void AddShapes(const mjModel& model, HandShapes& shapes) {
  for (int geom = 0; geom < model.ngeom; ++geom) {
    const std::optional<Form> form = FormOf(model.geom_type[geom]);
    const auto rgba = Colour(model, model.geom_matid[geom], CopyValues<4>(model.geom_rgba, geom));
    if (!form || model.geom_group[geom] >= kGroupsDrawn || rgba[3] == 0.0f) continue;
    shapes.shapes.push_back({.body = model.geom_bodyid[geom],
                             .form = *form,
                             .size_m = CopyValues<3>(model.geom_size, geom),
                             .frame = FrameAt(model.geom_pos, model.geom_quat, geom),
                             .rgba = rgba,
                             .mesh = *form == Form::kMesh ? model.geom_dataid[geom] : -1});
  }
  for (int mesh = 0; mesh < model.nmesh; ++mesh) {
    const float* vertex = model.mesh_vert + 3 * model.mesh_vertadr[mesh];
    const int* face = model.mesh_face + 3 * model.mesh_faceadr[mesh];
    shapes.meshes.push_back({.vertex_m = {vertex, vertex + 3 * model.mesh_vertnum[mesh]},
                             .triangle = {face, face + 3 * model.mesh_facenum[mesh]}});
  }
}

void AddCables(const mjModel& model, HandShapes& shapes) {
  for (int tendon = 0; tendon < model.ntendon; ++tendon) {
    const auto rgba =
        Colour(model, model.tendon_matid[tendon], CopyValues<4>(model.tendon_rgba, tendon));
    if (model.tendon_group[tendon] >= kGroupsDrawn || rgba[3] == 0.0f) continue;
    HandShapes::Cable cable{.rgba = rgba, .width_m = model.tendon_width[tendon], .points = {}};
    const int first = model.tendon_adr[tendon];
    for (int wrap = first; wrap < first + model.tendon_num[tendon]; ++wrap) {
      const int object = model.wrap_objid[wrap];
      if (model.wrap_type[wrap] == mjWRAP_SITE) {
        cable.points.push_back({.body = model.site_bodyid[object],
                                .frame = FrameAt(model.site_pos, model.site_quat, object),
                                .side = {}});
      } else if (model.wrap_type[wrap] == mjWRAP_CYLINDER ||
                 model.wrap_type[wrap] == mjWRAP_SPHERE) {
        HandShapes::CablePoint point{.body = model.geom_bodyid[object],
                                     .frame = FrameAt(model.geom_pos, model.geom_quat, object),
                                     .radius_m = model.geom_size[3 * object],
                                     .is_sphere = model.wrap_type[wrap] == mjWRAP_SPHERE,
                                     .side = {}};
        if (const int side = static_cast<int>(model.wrap_prm[wrap]); side >= 0) {
          point.side = {.body = model.site_bodyid[side],
                        .position_m = CopyValues<3>(model.site_pos, side)};
        }
        cable.points.push_back(point);
      }
    }
    if (cable.points.size() > 1) shapes.cables.push_back(cable);
  }
}

}  // namespace

HandShapes ShapesOf(const HandModel& hand, const std::string& camera) {
  const mjModel& model = hand.model();
  HandShapes shapes;
  for (int body = 0; body < model.nbody; ++body) {
    shapes.bodies.push_back({.parent = model.body_parentid[body],
                             .frame = FrameAt(model.body_pos, model.body_quat, body)});
  }
  AddHinges(hand, shapes);
  AddShapes(model, shapes);
  AddCables(model, shapes);
  if (const int id = mj_name2id(&model, mjOBJ_CAMERA, camera.c_str()); id >= 0) {
    shapes.camera = {.body = model.cam_bodyid[id],
                     .frame = FrameAt(model.cam_pos, model.cam_quat, id),
                     .height_deg = model.cam_fovy[id]};
  }
  shapes.object_body = hand.grasp().object_body;
  return shapes;
}

}  // namespace gauntlet::sim
